#pragma once

#include <span>

/// Quadrature rules on a triangle with positive weights and all points inside (model/NUMERICS.md, section
/// 12).
namespace fringe::detail {

/// A point at v₀ + second·(v₁ − v₀) + third·(v₂ − v₀).
struct TriangleNode {
  double second;
  double third;
  double weight;  ///< the weights of a rule add up to 1
};

/// A rule that is exact for polynomials up to `degree`.
struct TriangleRule {
  int degree;
  int points;
  /// Largest value of mean|δ|^k + Σw|δ|^k, k = degree + 1, over the triangles whose vertices lie within 1 of
  /// the centroid, δ the distance from the centroid.
  double bound_constant;
  const TriangleNode* nodes;
};

/// In the order of their degrees.
std::span<const TriangleRule> triangle_rules();

}  // namespace fringe::detail
