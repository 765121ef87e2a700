#include "integral/tree/moments.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "geometry.hpp"
#include "integral/edge_moment.hpp"
#include "integral/tree/build.hpp"
#include "integral/tree/compression.hpp"

/// Moments of surfaces and the few points that stand for them in the tree, against quadrature in closed form;
/// integrals of 1/distance along segments, against closed forms and what scales.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

std::vector<WeightedPoint> points_on(const std::vector<Triangle>& surface) {
  std::vector<WeightedPoint> points;
  for (const Triangle& triangle : surface)
    append_rule(triangle, twice_area(triangle) / 2, points);
  return points;
}

double power(const Vector3d& p, const Monomial& monomial) {
  return std::pow(p.x(), monomial.exponents[0]) * std::pow(p.y(), monomial.exponents[1]) *
         std::pow(p.z(), monomial.exponents[2]);
}

TEST(Monomials, AreAllOfTheirDegreesAndAddUpToPowersOfTheSum) {
  const Vector3d p(0.3, -0.7, 0.9);
  std::vector<double> sums(moment_degree + 1);
  int before = 0;
  for (std::size_t k = 0; k < all_monomials; ++k) {
    const auto& [exponents, degree, factor, axis, multinomial] = monomials[k];
    EXPECT_EQ(exponents[0] + exponents[1] + exponents[2], degree);
    EXPECT_EQ(monomial_index(exponents[0], exponents[1], exponents[2]), k);
    EXPECT_GE(degree, before);
    before = degree;
    if (degree > 0) {
      EXPECT_NEAR(power(p, monomials[k]), power(p, monomials[factor]) * p[axis], 1e-15);
    }
    sums[static_cast<std::size_t>(degree)] += multinomial * power(p, monomials[k]);
  }
  for (int degree = 0; degree <= moment_degree; ++degree)
    EXPECT_NEAR(sums[static_cast<std::size_t>(degree)], std::pow(p.sum(), degree), 1e-14);
}

// The moments of a flat square over [0, 1]²: 1/((a + 1)(b + 1)).
TEST(Moments, OfASquareAreThoseOfItsClosedFormUpToDegreeFive) {
  const std::vector<WeightedPoint> points = points_on(test::parallelogram({0, 0, 1}, {1, 0, 0}, {0, 1, 0}));
  const Moments found = moments_of(points, {});
  for (std::size_t k = 0; k < monomial_count(highest_degree); ++k) {
    const auto& exponents = monomials[k].exponents;
    EXPECT_NEAR(found[k], 1.0 / ((exponents[0] + 1) * (exponents[1] + 1)), 1e-14) << k;
  }
  MonomialValues sums{};
  MonomialRows(points, Vector3d::Zero(), Eigen::Matrix3d::Identity(), moment_degree,
               MonomialRows::Factor::weight)
      .add_up(sums);
  for (std::size_t k = 0; k < all_monomials; ++k)
    EXPECT_NEAR(sums[k], found[k], 1e-15) << k;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

double moment(const Vector3d& a, const Vector3d& b) {
  return edge_moment(a, b, a.norm(), b.norm());
}
double mean(const Vector3d& a, const Vector3d& b) {
  return mean_inverse_distance(a, b, a.norm(), b.norm());
}

// ∫ds/|A + s(B − A)| = ∫(1 − s) + ∫s, however close the segment is to the origin, and whatever its length.
TEST(EdgeMoment, OfBothDirectionsAddUpToTheMean) {
  test::Random random(2);
  for (int i = 0; i < 500; ++i) {
    const double size = std::pow(10, random.uniform(-30, 30)), gap = std::pow(10, random.uniform(-12, 0));
    const Vector3d a(size * random.uniform(-1, 0), size * gap, 0),
        b(size * random.uniform(0, 1), size * gap, 0);
    const double sum = moment(a, b) + moment(b, a);
    EXPECT_NEAR(sum / mean(a, b), 1, 1e-14);
    // The mean in closed form: (asinh(x_b/gap) − asinh(x_a/gap))/length.
    const double expected = (std::asinh(b.x() / a.y()) - std::asinh(a.x() / a.y())) / (b.x() - a.x());
    EXPECT_NEAR(mean(a, b) / expected, 1, 1e-13);
    EXPECT_NEAR(size * moment(a, b), moment(a / size, b / size), 1e-13 * size * moment(a, b));
  }
}

TEST(EdgeMoment, OnALineThroughTheOriginHasALogarithm) {
  test::Random random(3);
  for (int i = 0; i < 100; ++i) {
    const double a = random.uniform(0.1, 1), b = a + random.uniform(0.1, 1), length = b - a;
    // s = (r − a)/length: ∫(r − a)/r dr/length².
    const double expected = (length - a * std::log(b / a)) / (length * length);
    EXPECT_NEAR(edge_moment(a, b), expected, 1e-13 * expected / length);
    EXPECT_NEAR(moment({0, a, 0}, {0, b, 0}), edge_moment(a, b), 1e-14);
  }
  EXPECT_EQ(edge_moment(0, 0.5), 2);
  EXPECT_EQ(edge_moment(1, 0), infinity);
  EXPECT_EQ(moment({0, 0, 0}, {0, 4, 0}), 0.25);
  EXPECT_EQ(moment({0, 4, 0}, {0, 0, 0}), infinity);
  EXPECT_EQ(moment({-1, 0, 0}, {1, 0, 0}), infinity);
}

TEST(EdgeMoment, LogarithmsOfRatiosDoNotOverflow) {
  EXPECT_NEAR(log_of_ratio(1e300, 1e-300), 600 * std::log(10), 1e-12);
  EXPECT_NEAR(log_of_ratio(1e-300, 1e300), -600 * std::log(10), 1e-12);
  EXPECT_EQ(log_of_ratio(3, 3), 0);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
