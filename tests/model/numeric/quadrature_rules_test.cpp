/// Quadrature rules on the unit interval and on triangles, against integrals of monomials in closed form.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "numeric/gauss_node.hpp"
#include "numeric/gauss_rule.hpp"
#include "numeric/triangle_rules.hpp"

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
        EXPECT_NEAR(sum / mean_of_monomial(i, j), 1, 1e-12) << rule.degree << ": " << i << ' ' << j;
      }
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
