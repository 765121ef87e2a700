#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

/// Quadrature rules: those of Gauss on an interval, and rules on a triangle with positive weights and
/// interior points (model/NUMERICS.md, section 12).
namespace fringe::detail {

struct GaussNode {
  double position;  ///< in (0, 1)
  double weight;    ///< the weights of a rule add up to 1
};

using GaussRule = std::vector<GaussNode>;

/// Returns the Gauss–Legendre rule on [0, 1].
GaussRule gauss_rule(int points);

/// A quadrature point at v₀ + second·(v₁ − v₀) + third·(v₂ − v₀), with its weight.
struct TriangleNode {
  double second;
  double third;
  double weight;  ///< the weights of a rule add up to 1
};

/// A rule that is exact for polynomials up to `degree`.
struct TriangleRule {
  int degree;
  int points;
  /// Largest value of mean|δ|^k + Σw|δ|^k, where k = degree + 1 and δ is the offset from the centroid, over
  /// all triangles whose vertices lie within distance 1 of the centroid.
  double bound_constant;
  const TriangleNode* nodes;
};

/// Returns all rules in the order of their degrees.
std::span<const TriangleRule> triangle_rules();

/// Returns the rule of a degree that is among them.
inline const TriangleRule& triangle_rule(int degree) {
  const auto rules = triangle_rules();
  return *std::find_if(rules.begin(), rules.end(),
                       [&](const TriangleRule& rule) { return rule.degree == degree; });
}

/// Returns a quadrature point of a triangle.
template <class Point>
Point point_of(const std::array<Point, 3>& triangle, const TriangleNode& node) {
  const auto& [a, b, c] = triangle;
  return a + node.second * (b - a) + node.third * (c - a);
}

}  // namespace fringe::detail
