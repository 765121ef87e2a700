/// Interactions ∫∫1/r of two triangles with unit charges, against closed forms and what must not matter.

#include "bem/panel_pair.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "bem/panel.hpp"
#include "bem/panel_quadrature.hpp"
#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

double interaction(const Triangle& a, const Triangle& b, double tolerance = 1e-8) {
  PotentialSums sums;
  double sum = 0;
  add_pair(make_panel(a), make_panel(b), tolerance, sums, sum);
  sums.flush();
  return sum;
}

double self(const Triangle& triangle) {
  return panel_self(make_panel(triangle));
}

Triangle moved(const Triangle& triangle, const Eigen::Isometry3d& pose, double factor = 1) {
  return {factor * (pose * triangle[0]), factor * (pose * triangle[1]), factor * (pose * triangle[2])};
}

// The mean of 1/r between two points of the unit square is 4·ln(1 + √2) + 4/3·(1 − √2).
TEST(PanelPair, TwoHalvesOfASquareMakeUpTheSquare) {
  const double root = std::sqrt(2.0), mean = 4 * std::log(1 + root) + 4.0 / 3 * (1 - root);
  const std::vector<Triangle> halves = test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const double sum = self(halves[0]) + self(halves[1]) + 2 * interaction(halves[0], halves[1]);
  EXPECT_NEAR(sum / 4, mean, 1e-7);
}

// A panel interacts with itself as its quarters do with each other, of charges ¼.
TEST(PanelPair, APanelsOwnInteractionIsThatOfItsQuarters) {
  test::Random random(1);
  for (int i = 0; i < 10; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const std::array<Triangle, 4> parts = quarters(triangle);
    double sum = 0;
    for (const Triangle& a : parts)
      for (const Triangle& b : parts)
        sum += &a == &b ? self(a) : interaction(a, b);
    EXPECT_NEAR(sum / 16, self(triangle), 1e-6 * self(triangle));
  }
}

TEST(PanelPair, IsSymmetricAndDoesNotDependOnWhereBothAre) {
  test::Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Triangle a = random.triangle_in_box({-1, -1, -1}, {1, 1, 1}),
                   b = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Eigen::Isometry3d pose = random.rigid_motion();
    const double found = interaction(a, b, 1e-6);
    EXPECT_NEAR(interaction(b, a, 1e-6), found, 1e-5 * found);
    EXPECT_NEAR(interaction(moved(a, pose), moved(b, pose), 1e-6), found, 1e-5 * found);
    EXPECT_NEAR(interaction(moved(a, pose, 1e-3), moved(b, pose, 1e-3), 1e-6), 1e3 * found, 1e-2 * found);
    // Two halves of a have half of its charge each.
    const std::array<Triangle, 2> parts = halves(a, longest_side(a));
    EXPECT_NEAR((interaction(parts[0], b, 1e-6) + interaction(parts[1], b, 1e-6)) / 2, found, 1e-5 * found);
    EXPECT_LT(found, std::sqrt(self(a) * self(b)));
  }
}

TEST(PanelPair, OfDistantPanelsIsThatOfPointCharges) {
  test::Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Triangle a = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Eigen::Isometry3d away(Eigen::Translation3d(1000, 200, -300));
    const Triangle b = moved(random.triangle_in_box({-1, -1, -1}, {1, 1, 1}), away);
    const double distance = (make_panel(a).centre - make_panel(b).centre).norm();
    EXPECT_NEAR(interaction(a, b) * distance, 1, 2e-6);
  }
}

/// The mean of a potential over a triangle by a rule that is told how far its singularity is.
TEST(PanelQuadrature, GivesTheMeanOfThePotentialOfACharge) {
  test::Random random(4);
  for (int i = 0; i < 30; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, 0}, {1, 1, 0.2});
    const Vector3d charge = random.in_box({-1, -1, 0.3}, {1, 1, 1});
    const auto distance = [&](const Vector3d& point) { return (point - charge).norm(); };
    const auto mean_of = [&](const Triangle& part, double tolerance) {
      double weights = 0, sum = 0;
      for_each_point(part, tolerance, distance, [&](const Vector3d& point, double weight) {
        weights += weight;
        sum += weight / distance(point);
      });
      EXPECT_NEAR(weights, 1, 1e-12);
      return sum;
    };
    // Of quarters of quarters of quarters.
    std::vector<Triangle> parts{triangle};
    for (int k = 0; k < 3; ++k) {
      std::vector<Triangle> finer;
      for (const Triangle& part : parts)
        for (const Triangle& quarter : quarters(part))
          finer.push_back(quarter);
      parts = finer;
    }
    double expected = 0;
    for (const Triangle& part : parts)
      expected += mean_of(part, 1e-9) / static_cast<double>(parts.size());
    for (const double tolerance : {1e-2, 1e-4, 1e-6})
      EXPECT_NEAR(mean_of(triangle, tolerance), expected, tolerance * expected);
  }
  // Tighter tolerances and lower degrees need greater distances.
  EXPECT_LT(far_ratio(1e-6, 4), far_ratio(1e-3, 4));
  EXPECT_LT(far_ratio(1e-6, 2), far_ratio(1e-6, 4));
}

TEST(PanelQuadrature, AlongASegmentGivesItsLogarithm) {
  const Vector3d from(-1, 0.1, 0), to(1, 0.1, 0);
  const auto distance = [](const Vector3d& a, const Vector3d& b) {
    return segment_distance(Vector3d::Zero(), a, b);
  };
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    double weights = 0, sum = 0;
    for_each_point(from, to, tolerance, distance, [&](const Vector3d& point, double weight) {
      weights += weight;
      sum += weight / point.norm();
    });
    EXPECT_NEAR(weights, 1, 1e-12);
    // Parts of little weight may be less exact.
    EXPECT_NEAR(sum, std::asinh(10.0), 100 * tolerance);
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
