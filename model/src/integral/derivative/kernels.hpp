#pragma once

#include <cstddef>
#include <cstdint>

#include "integral/batch/kernels.hpp"

/// Derivatives of ∫dA/d with respect to the pose of the triangle, many triangles at a time
/// (model/NUMERICS.md, section 15).
///
/// The kernels are compiled once for every instruction set: the declarations here obey the rule in
/// simd/dispatch.hpp.
namespace fringe::detail {

/// Number of sums: ∫v/|v|³ dA and ∫n × v/|v|³ dA along the plate's axes, where n is the plate's point nearest
/// to a point of the triangle and v the vector from it to that point.
constexpr std::size_t wrench_components = 6;

/// Pieces of triangles, each in one cell of the plate: the vectors from the plate's nearest points to the
/// corners (v0.x, v0.y, … v2.z), these nearest points (n0.x, n0.y, n1.x, … n2.y), and twice the area. All
/// arrays are readable up to the next multiple of TriangleArrays::padding.
struct PlacedPieces {
  const double* vectors[9];
  const double* nearest[6];
  const double* weight;
};

/// The functions for one instruction set. Both add to `sums`; these become NaN when a triangle comes closer
/// to the plate than `least_distance`. All lengths are multiplied by `scale`, a power of two, first.
struct DerivativeKernels {
  /// Adds the triangles that lie in one cell of the plate. Writes the indices of the others to `left`, which
  /// needs room for all, and returns how many these are.
  std::size_t (*add_triangles)(const TriangleArrays& triangles, std::size_t count,
                               const PlateCoordinates& plate, double scale, const Choices& choices,
                               double least_distance, double* sums, std::uint32_t* left);

  /// Adds pieces.
  void (*add_pieces)(const PlacedPieces& pieces, std::size_t count, double scale, const Choices& choices,
                     double least_distance, double* sums);
};

}  // namespace fringe::detail
