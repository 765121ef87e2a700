/// Integrals of 1/distance along segments, against quadrature, closed forms and what scales.

#include "integral/edge_moment.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry.hpp"
#include "numeric/gauss_rule.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();

double moment(const Vector3d& a, const Vector3d& b) {
  return edge_moment(a, b, a.norm(), b.norm());
}
double mean(const Vector3d& a, const Vector3d& b) {
  return mean_inverse_distance(a, b, a.norm(), b.norm());
}

TEST(EdgeMoment, IsTheIntegralByQuadrature) {
  test::Random random(1);
  const GaussRule rule = gauss_rule(20);
  for (int i = 0; i < 200; ++i) {
    // No closer to the origin than a fifth of its length.
    const Vector3d a = random.in_box({-1, -1, 0.5}, {1, 1, 1}), b = random.in_box({-1, -1, 0.5}, {1, 1, 1});
    double of_moment = 0, of_mean = 0;
    constexpr int parts = 8;
    for (int part = 0; part < parts; ++part)
      for (const auto& [position, weight] : rule) {
        const double s = (part + position) / parts, inverse = weight / parts / (a + s * (b - a)).norm();
        of_moment += s * inverse;
        of_mean += inverse;
      }
    EXPECT_NEAR(moment(a, b), of_moment, 1e-14 * of_moment);
    EXPECT_NEAR(mean(a, b), of_mean, 1e-14 * of_mean);
  }
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
