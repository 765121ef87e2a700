#include "bem/conductors_at_rest.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "fringe/scene.hpp"
#include "scenes.hpp"
#include "two_balls.hpp"

/// Conductors by boundary elements: two balls by image charges.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Triangles lie between the balls of their corners and smaller ones, and charges grow with the bodies.
TEST(ConductorsAtRestTest, TwoBallsHaveTheChargesOfTheirImages) {
  constexpr int segments = 24;
  constexpr double first = 0.05, second = 0.03, distance = 0.1, rtol = 2e-2;
  Scene scene;
  scene.objects = {test::object("first", Sphere{first, segments}, test::at(0, 0, 0), Electrode{}),
                   test::object("second", Sphere{second, segments}, test::at(distance, 0, 0))};
  const ConductorsAtRest found(charged_bodies(scene), rtol, 4000);
  const MatrixXd& matrix = found.matrix();
  ASSERT_EQ(matrix.rows(), 2);
  const double inside = std::pow(std::cos(EIGEN_PI / segments), 2);
  const auto [own, other] = test::two_balls(first, second, distance);
  const auto [least_own, least_other] = test::two_balls(inside * first, inside * second, distance);
  EXPECT_LT(matrix(0, 0), own);
  EXPECT_GT(matrix(0, 0), (1 - rtol) * least_own);
  EXPECT_LT(-matrix(1, 0), -other);
  EXPECT_GT(-matrix(1, 0), -(1 - rtol) * least_other);
  EXPECT_LT(matrix(1, 1), test::two_balls(second, first, distance)[0]);
  EXPECT_NEAR(matrix(0, 1), matrix(1, 0), 1e-3 * std::abs(other));
  // The charges of the panels add up to the matrix.
  MatrixXd sums = MatrixXd::Zero(2, 2);
  for (const PanelGroup& group : found.mesh().groups())
    sums.row(static_cast<Index>(found.bodies().bodies[group.body].conductor)) +=
        found.charges()
            .middleRows(static_cast<Index>(group.first), static_cast<Index>(group.count))
            .colwise()
            .sum();
  EXPECT_LT((sums - matrix).norm(), 1e-2 * matrix.norm());
  EXPECT_LE(found.error(), rtol);
}

TEST(ConductorsAtRestTest, AFloatingBallHasTheCapacitanceOfTheRoundOne) {
  constexpr int segments = 24;
  constexpr double radius = 0.05, rtol = 2e-2;
  Scene scene;
  scene.objects = {test::object("ball", Sphere{radius, segments}, test::at(0, 0, 0))};
  ChargedBodies bodies = charged_bodies(scene);
  bodies.conductors.front().role = Role::floating;
  bodies.conductors.front().is_asked = true;
  const ConductorsAtRest found(std::move(bodies), rtol, 4000);
  ASSERT_EQ(found.matrix().rows(), 1);
  EXPECT_LT(found.matrix()(0, 0), radius);
  EXPECT_GT(found.matrix()(0, 0), (1 - rtol) * std::pow(std::cos(EIGEN_PI / segments), 2) * radius);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
