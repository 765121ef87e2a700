#pragma once

#include <cstddef>

/// The inner loops of boundary elements, in the widest registers of the processor: the potentials of charges
/// at points (model/BOUNDARY_ELEMENTS.md, sections 5 and 9).
///
/// Compiled once for every instruction set: what is declared here obeys the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// Number of functions in a block. Kernels read weights and write results in whole blocks.
constexpr std::ptrdiff_t face_block = 8;

constexpr std::ptrdiff_t whole_face_blocks(std::ptrdiff_t count) {
  return (count + face_block - 1) / face_block * face_block;
}

/// A quadrature rule along one direction of a face.
struct RuleView {
  std::ptrdiff_t points;
  std::ptrdiff_t functions;
  std::ptrdiff_t stride;  ///< whole_face_blocks(functions) or more
  const double* nodes;    ///< in [−1, 1]
  const double* weights;  ///< weight·(1 − x²)^α·p_k(x): a row of `stride` for every point
};

/// A point in a face's coordinates, and the face's half sides; all members are lengths.
struct FacePoint {
  double x;
  double y;
  double z;
  double half_u;
  double half_v;
};

/// Returns the number of values of scratch space that face_potentials needs.
constexpr std::size_t face_scratch(const RuleView& u, const RuleView& v) {
  return static_cast<std::size_t>((1 + face_block) * u.points +
                                  (1 + u.functions) * whole_face_blocks(v.points));
}

/// The kernels for one instruction set.
struct ChargeKernels {
  /// Computes the potentials of f_k(x)·f_l(y) at the point, in element l + k·v.functions.
  void (*face_potentials)(const FacePoint& point, const RuleView& u, const RuleView& v, double* scratch,
                          double* result);

  /// Computes the potentials of triangles of any shape, each with a unit charge spread evenly, at points that
  /// may also lie in their planes, on their sides and at their corners. The error is 1e-12 where the distance
  /// is no more than a hundred heights. `components` are the vectors from the points to the corners, v0.x,
  /// v0.y, … v2.z, in whole face_blocks.
  void (*triangle_potentials)(const double* const (&components)[9], std::size_t count, double* potentials);

  /// Computes the solid angles of triangles at points, over 4π: positive where the triangle's normal, by the
  /// order of its corners, points away from the point, and zero in the triangle's plane. `components` as
  /// above.
  void (*solid_angles)(const double* const (&components)[9], std::size_t count, double* angles);
};

}  // namespace fringe::detail
