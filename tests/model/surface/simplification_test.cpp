/// Tests surfaces of many triangles that boundary elements simplify, and what their answers say of it.

#include "surface/simplification.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/interruption.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::charged_bodies;
using detail::Simplification;
using Eigen::Vector3d;
using test::at;
using test::object;

constexpr double radius = 0.1;
constexpr std::size_t any_number = 1'000'000;

/// Returns a ball of so many segments, and a sensor of 3 cm at a distance of 1 cm.
Scene ball_beside_sensor(int segments) {
  return test::scene_of(test::square(0.03, -0.01 - radius),
                        {object("ball", Sphere{radius, segments}, at(0, 0, 0))});
}

std::size_t triangles_of_ball(const detail::ChargedBodies& bodies) {
  return triangles_of(bodies.bodies.back().surface).size();
}

TEST(Simplification, LeavesFewTrianglesAsTheyAre) {
  const Simplification same(charged_bodies(ball_beside_sensor(48)), 0.1, any_number);
  EXPECT_FALSE(same.is_changed());
  EXPECT_EQ(triangles_of_ball(same.bodies()), 2208U);
  EXPECT_EQ(same.deviation(1, Vector3d(0, 0, radius)), 0);
}

TEST(Simplification, IsFinerTowardsOtherConductors) {
  const Simplification coarse(charged_bodies(ball_beside_sensor(96)), 0.03, any_number);
  ASSERT_TRUE(coarse.is_changed());
  const auto triangles = triangles_of(coarse.bodies().bodies.back().surface);
  EXPECT_LT(triangles.size(), 2500U) << "of 9,024";
  EXPECT_NEAR(area(triangles), 4 * std::numbers::pi * radius * radius, 0.02 * radius * radius * 12);
  const double near = coarse.deviation(1, Vector3d(0, 0, -radius)),
               far = coarse.deviation(1, Vector3d(0, 0, radius));
  EXPECT_LT(near, 0.03 * 0.01);
  EXPECT_LT(far, 0.03 * radius);
  EXPECT_LT(3 * near, far);
  for (const Triangle& triangle : triangles)
    for (const Vector3d& corner : triangle)
      EXPECT_NEAR(corner.norm(), radius, 1e-12) << "vertices stay where they are";
}

TEST(Simplification, IsCoarserWhereFewTrianglesAreAllowed) {
  const Simplification some(charged_bodies(ball_beside_sensor(96)), 0.01, any_number),
      few(charged_bodies(ball_beside_sensor(96)), 0.01, 1500);
  EXPECT_LE(triangles_of_ball(few.bodies()), 1500U);
  EXPECT_GT(triangles_of_ball(some.bodies()), 1500U);
  EXPECT_GT(few.deviation(1, Vector3d(0, 0, radius)), some.deviation(1, Vector3d(0, 0, radius)));
}

/// A ball keeps its shape to a part of its size. Where all conductors are there, it may lose more as a small
/// part of one that is far from the others.
TEST(Simplification, IsCoarserOnASmallPartOfALargeConductor) {
  const auto triangles_of_pair = [](const std::optional<std::string>& conductor, double of_part) {
    Scene scene = test::scene_of(test::square(0.03, -5), {object("ball", Sphere{radius, 8}, at(2, 0, 0)),
                                                          object("same", Sphere{radius, 96}, at(0, 0, 0))});
    for (Object& each : scene.objects)
      each.conductor = conductor;
    return triangles_of_ball(Simplification(charged_bodies(scene), 0.03, any_number, {}, of_part).bodies());
  };
  const std::size_t whole = triangles_of_pair(std::nullopt, 4), part = triangles_of_pair("machine", 4);
  EXPECT_LT(3 * part, whole);
  EXPECT_GT(part, 50U);
  EXPECT_EQ(triangles_of_pair("machine", 1), whole);
}

TEST(Simplification, EndsWhereItIsAskedTo) {
  const detail::ChargedBodies bodies = charged_bodies(ball_beside_sensor(96));
  const InterruptionScope scope([] { return true; });
  EXPECT_THROW(Simplification(bodies, 0.1, any_number), Interrupted);
}

/// The capacitance of a ball, 4πεR, is greater than that of its triangles by twice their mean depth at most.
TEST(Simplification, IsPartOfTheStatedErrors) {
  Scene scene;
  scene.objects = {object("ball", Sphere{radius, 96}, at(0, 0, 0))};
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-2});
  EXPECT_TRUE(answer.reached);
  const double depth = 1 - std::cos(std::numbers::pi / 96),
               relative = test::per_length(answer.values(0, 0), radius);
  EXPECT_NEAR(relative, 1, test::per_length(answer.errors(0, 0), radius) + 2 * depth);
  EXPECT_FALSE(answer.lower_bounds[0]) << "the simplified ball might be the larger one";
}

TEST(Simplification, OfMoreThanEverFitAnswersWithWhatItCosts) {
  const MaxwellMatrix answer = maxwell(ball_beside_sensor(96), {.rtol = 1e-4, .most_unknowns = 3000});
  EXPECT_FALSE(answer.reached);
  const MaxwellMatrix fine = maxwell(ball_beside_sensor(48), {.rtol = 3e-3});
  const double depth = 1 - std::cos(std::numbers::pi / 48);
  for (Eigen::Index i = 0; i < 2; ++i)
    EXPECT_NEAR(answer.values(i, 1), fine.values(i, 1),
                answer.errors(i, 1) + fine.errors(i, 1) + 20 * depth * std::abs(fine.values(i, 1)));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
