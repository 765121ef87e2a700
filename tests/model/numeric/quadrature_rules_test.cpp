/// Quadrature rules on the unit interval and on triangles, against integrals of monomials in closed form.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "numeric/quadrature_rules.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

TEST(QuadratureRules, OfGaussAreExactUpToTheirDegree) {
  for (const int points : {1, 2, 3, 5, 8, 16, 20}) {
    const GaussRule rule = gauss_rule(points);
    ASSERT_EQ(rule.size(), static_cast<std::size_t>(points));
    EXPECT_TRUE(std::all_of(rule.begin(), rule.end(), [](const GaussNode& node) {
      return node.position > 0 && node.position < 1 && node.weight > 0;
    }));
    const auto integral = [&](int power) {
      double sum = 0;
      for (const auto& [position, weight] : rule)
        sum += weight * std::pow(position, power);
      return sum;
    };
    for (int power = 0; power < 2 * points; ++power)
      EXPECT_NEAR(integral(power) * (power + 1), 1, 1e-13) << points << " points, x^" << power;
    if (points < 5) {
      EXPECT_GT(std::abs(integral(2 * points) * (2 * points + 1) - 1), 1e-6);
    }
  }
}

/// The mean of second^i · third^j over the triangle: 2·i!·j!/(i + j + 2)!.
double mean_of_monomial(int i, int j) {
  return 2 * std::tgamma(i + 1) * std::tgamma(j + 1) / std::tgamma(i + j + 3);
}

TEST(QuadratureRules, OfTrianglesAreExactUpToTheirDegree) {
  int before = 0;
  for (const TriangleRule& rule : triangle_rules()) {
    EXPECT_GT(rule.degree, before);
    before = rule.degree;
    const std::span nodes(rule.nodes, static_cast<std::size_t>(rule.points));
    for (const auto& [second, third, weight] : nodes)
      EXPECT_TRUE(second > 0 && third > 0 && second + third < 1 && weight > 0) << rule.degree;
    for (int i = 0; i <= rule.degree; ++i)
      for (int j = 0; i + j <= rule.degree; ++j) {
        double sum = 0;
        for (const auto& [second, third, weight] : nodes)
          sum += weight * std::pow(second, i) * std::pow(third, j);
        const double mean = mean_of_monomial(i, j);
        EXPECT_NEAR(sum, mean, std::min(1e-12 * mean, 1e-15)) << rule.degree << ": " << i << ' ' << j;
      }
  }
}

/// Returns Σw|δ|^power over the nodes of a rule on the triangle whose vertices are 1, e^(i·angle) and what
/// brings its centroid to the origin.
double sum_of_powers(std::span<const TriangleNode> nodes, double angle, int power) {
  const std::complex<double> first = 1, second = std::polar(1.0, angle), third = -first - second;
  double sum = 0;
  for (const TriangleNode& node : nodes)
    sum += node.weight *
           std::pow(std::abs(first + node.second * (second - first) + node.third * (third - first)), power);
  return sum;
}

// A convex function of the vertices is largest where two of them lie at distance 1 from the centroid, seen
// from there under an angle between 120° and 180°.
TEST(QuadratureRules, OfTrianglesHaveTheConstantsOfTheirErrorBound) {
  std::vector<TriangleNode> fine;
  for (const auto& [u, weight_u] : gauss_rule(20))
    for (const auto& [v, weight_v] : gauss_rule(20))
      fine.push_back({u * (1 - v), u * v, 2 * u * weight_u * weight_v});
  for (const TriangleRule& rule : triangle_rules()) {
    const std::span nodes(rule.nodes, static_cast<std::size_t>(rule.points));
    double largest = 0;
    for (int step = 0; step <= 100; ++step) {
      const double angle = std::numbers::pi * (2 + step / 100.0) / 3;
      largest = std::max(largest, sum_of_powers(fine, angle, rule.degree + 1) +
                                      sum_of_powers(nodes, angle, rule.degree + 1));
    }
    EXPECT_LT(largest, rule.bound_constant) << rule.degree;
    EXPECT_GT(1.02 * largest, rule.bound_constant) << rule.degree;
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
