#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// Integrals of many triangles at a time, in the processor's widest registers (model/NUMERICS.md, section
/// 12).
///
/// The kernels are compiled once for every instruction set: the declarations here obey the rule in
/// simd/dispatch.hpp.
namespace fringe::detail {

/// A plate's coordinates (PlateFrame) as plain numbers.
struct PlateCoordinates {
  double corner[3];
  double axes[9];  ///< row by row
  double length_u;
  double length_v;
};

/// Triangles as a structure of arrays: the nine coordinates of the vertices (v0.x, v0.y, … v2.z), twice the
/// area, and the largest squared distance of a vertex from the centroid. All arrays are readable up to the
/// next multiple of `padding` triangles.
struct TriangleArrays {
  const double* coordinates[9];
  const double* twice_area;
  const double* squared_size;

  static constexpr std::size_t padding = 8;

  /// Number of pieces into which one border plane cuts a triangle, at most.
  static constexpr std::size_t most_pieces = 3;
};

/// A quadrature rule on the triangle with the largest squared ratio of size to distance for which it
/// suffices.
struct RuleChoice {
  double largest_squared_ratio;
  const struct TriangleNode* nodes;
  int points;
};

/// Largest ratio of a virtual triangle's length to its distance from the origin for which the Gauss rules
/// along the height are used.
constexpr double most_lengths = 5;

/// A Gauss rule along the height with the smallest squared ratio of distance to height for which it suffices.
struct HeightRuleChoice {
  double smallest_squared_ratio;
  const struct GaussNode* nodes;
  int points;
};

/// The rules from which the cheapest sufficient one is chosen, triangle by triangle.
struct Choices {
  std::span<const RuleChoice> rules;               ///< from few points to many
  std::span<const HeightRuleChoice> height_rules;  ///< from few points to many
};

/// Virtual triangles, each lying in one cell, given by the vectors from the plate's nearest points to their
/// vertices (v0.x, v0.y, … v2.z). All arrays are readable up to the next multiple of TriangleArrays::padding.
struct VirtualTriangles {
  const double* components[9];
  const double* weight;  ///< twice the area
};

/// The functions for one instruction set.
struct BatchKernels {
  /// Sets twice_area and squared_size of triangles given by their coordinates, in whole registers.
  void (*measure)(const double* const (&coordinates)[9], std::size_t count, double* twice_area,
                  double* squared_size);

  /// Adds ∫dA/d of each triangle to values[i]. Triangles that need more care (several borders, contact,
  /// extreme shapes) are left out: their values[i] are meaningless, and their indices are written to `left`,
  /// some more than once. `left` needs room for most_pieces times the number of triangles. Returns how many
  /// indices were written.
  std::size_t (*integrate)(const TriangleArrays& triangles, std::size_t count, const PlateCoordinates& plate,
                           const Choices& choices, double* values, std::uint32_t* left);

  /// Does the same for virtual triangles: adds weight·K of each to values[i], and writes each to `left` at
  /// most once.
  std::size_t (*integrate_virtual)(const VirtualTriangles& triangles, std::size_t count,
                                   const Choices& choices, double* values, std::uint32_t* left);

  /// Computes Σ weight/distance over points, whose arrays are readable up to the next multiple of
  /// TriangleArrays::padding.
  double (*sum_over_nodes)(const PlateCoordinates& plate, const double* x, const double* y, const double* z,
                           const double* weight, std::size_t count);

  /// Sets values[r·stride + c] to 1/√(|row r − column c|² + squared_softness). The columns' coordinates x, y,
  /// z and the rows of values are padded to whole registers; the rows' coordinates are interleaved, three per
  /// point.
  void (*soft_inverse_distances)(const double* const (&columns)[3], std::size_t stride, const double* rows,
                                 std::size_t row_count, double squared_softness, double* values);
};

}  // namespace fringe::detail
