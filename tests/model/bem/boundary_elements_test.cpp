/// Tests Maxwell matrices by boundary elements: published values, walls as mirrors, and stated errors. What
/// holds of every method is in tests/model/scene/matrices_by_method_test.cpp, the set-ups whose matrix is
/// known from another boundary-element method are in test_boundary_elements.py.

#include "fringe/boundary_elements.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bem/panel_system.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using namespace test;

Object mesh(const std::vector<Triangle>& triangles) {
  return object("mesh", Mesh{"", 1, triangles}, at(0, 0, 0));
}

TEST(BoundaryElementsAtLength, StateErrorsThatHoldWhereEdgesComeCloseToAFace) {
  // Found among random poses: five and seven functions along each side both miss the other's edges, and
  // agree.
  Eigen::Isometry3d inclined = at(-0.003, 0.003, 0.0092);
  inclined.rotate(Eigen::AngleAxisd(0.0506, Eigen::Vector3d::UnitX()));
  Scene plates, box;
  plates.sensors = box.sensors = {sensor("sensor", {square(0.1, 0)})};
  plates.objects = {object("plate", Plate{0.198, 0.092}, inclined)};
  box.objects = {object("box", Cuboid{0.077, 0.225, 0.05}, at(0, -0.004, 0.0368))};
  for (const Scene& scene : {plates, box}) {
    const MaxwellMatrix truth = maxwell(scene, {.rtol = 1e-4});
    for (const double rtol : {1e-2, 3e-3, 1e-3}) {
      const MaxwellMatrix answer = maxwell(scene, {.rtol = rtol});
      EXPECT_TRUE(covers(answer, truth)) << rtol;
    }
  }
}

TEST(BoundaryElements, WithTooFewUnknownsForTheFeaturesStateLargerErrors) {
  Scene scene = scene_of(square(0.1, 0), {object("plate", Plate{0.2, 0.09}, at(0, 0, 0.004))});
  const MaxwellMatrix truth = maxwell(scene, {.rtol = 1e-4});
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-2, .most_unknowns = 60});
  EXPECT_FALSE(answer.reached);
  EXPECT_TRUE(((answer.values - truth.values).cwiseAbs().array() <= answer.errors.array()).all());
}

TEST(BoundaryElements, ALargeSensorIsFeltByASmallPlateAsAWallIs) {
  Scene scene = scene_of(square(4, 0), {object("plate", Plate{0.1, 0.1}, at(0, 0, 0.01))});
  Scene reversed = scene_of(square(0.1, 0.01), {object("wall", Plate{4, 4}, at(0, 0, 0))});
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-2}), other = maxwell(reversed, {.rtol = 1e-2});
  EXPECT_TRUE(answer.reached);
  EXPECT_NEAR(answer.values(0, 1), other.values(1, 0), answer.errors(0, 1) + other.errors(1, 0));
  EXPECT_EQ(answer.sensors, 1U);
  // Without charge of its own, so small a plate parallel to the wall would have hardly any effect: the effect
  // is that of its charge.
  const double felt = std::pow(answer.values(0, 1), 2) / answer.values(1, 1);
  EXPECT_NEAR(answer.delta_self[0], felt, answer.delta_self_errors[0]);
  EXPECT_LT(answer.delta_self_errors[0], 0.02 * felt);
}

TEST(BoundaryElements, BeforeAWallFourThousandTimesLargerFeelWhatIsFeltBeforeTheMirrorImage) {
  // The sensor is smaller than any element of the wall before refinement. Functions on the whole wall would
  // not resolve it: triangles take their place.
  constexpr double side = 1e-3;
  const Shape plate = Plate{4, 4};
  for (const double gap : {1e-4, 1e-3})
    for (const auto& [wall, thickness] : {std::pair(plate, 0.0), std::pair(Shape(Cuboid{4, 4, 0.2}), 0.2),
                                          std::pair(Shape(Mesh{"", 1, triangulate(plate)}), 0.0)}) {
      Scene scene, image;
      scene.sensors = image.sensors = {sensor("small", {square(side, 0)})};
      scene.objects = {object("wall", wall, at(0.1, -0.1, -gap - thickness / 2))};
      image.objects = {object("image", Plate{side, side}, at(0, 0, -2 * gap))};
      const MaxwellMatrix mirrored = maxwell(image, {.rtol = 1e-4}), answer = maxwell(scene, {.rtol = 1e-2});
      const double expected = mirrored.values(0, 0) - mirrored.values(0, 1);
      EXPECT_TRUE(answer.reached);
      EXPECT_NEAR(answer.values(0, 0), expected, answer.errors(0, 0)) << gap;
    }
}

/// Two-terminal C/(εA/gap), from boundary elements to 1e-4.
TEST(BoundaryElements, AgreeWithKnownCapacitancesOfParallelSquares) {
  constexpr std::array<std::pair<double, double>, 5> known{
      {{0.1, 1.3057}, {0.2, 1.5528}, {0.5, 2.2364}, {1, 3.3430}, {2, 5.581}}};
  for (const auto& [gap, truth] : known) {
    Scene scene;
    scene.sensors = {sensor("lower", {square(1, 0)}), sensor("upper", {square(1, gap)})};
    const MatrixXd m = maxwell(scene, {.rtol = 1e-3}).values;
    const double two_terminal = (m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1)) / (m(0, 0) + m(1, 1) + 2 * m(0, 1));
    EXPECT_NEAR(two_terminal / (vacuum_permittivity / gap), truth, 3e-4 * truth) << gap;
  }
}

/// The Galerkin error falls like n^(−3.2) or faster on a plate: the field at its corners limits the order.
TEST(BoundaryElements, ConvergeInTheOrderOfTheCorners) {
  Scene scene;
  scene.sensors = {sensor("plate", {square(1, 0)})};
  const detail::ChargedBodies bodies = detail::charged_bodies(scene);
  // C/4πεa, to one unit in the last place (two independent boundary-element computations).
  constexpr double of_square = 0.366788;
  const auto error = [&](int n) {
    detail::PanelSystem system(bodies);
    system.refine({{n, n}}, 1e-9);
    return of_square - system.solve(1e-9).all.fine(0, 0);
  };
  EXPECT_GT(std::log(error(3) / error(7)) / std::log(7.0 / 3.0), 3.1);
}

/// A mesh of many triangles is not divided; the stated error contains what the triangles would gain from
/// division.
TEST(BoundaryElements, TheStatedErrorCoversWhatFinerPanelsFind) {
  Scene scene =
      scene_of(square(0.1, 0), {object("ball", Mesh{"", 1, triangulate(Sphere{0.03, 36})}, at(0, 0, 0.05))});
  const MaxwellMatrix given = maxwell(scene, {.rtol = 1e-2});
  EXPECT_EQ(given.unknowns, 1224U + 25U);
  const detail::ChargedBodies bodies = detail::charged_bodies(scene);
  detail::PanelSystem system(bodies);
  system.refine({{9, 9}}, 1e-4);
  system.refine_groups(std::vector<int>(system.mesh().groups().size(), 1), system.solve(1e-4).charges);
  system.refine({{9, 9}}, 1e-4);
  const MatrixXd finer = 4 * EIGEN_PI * vacuum_permittivity * system.solve(1e-6).all.fine;
  EXPECT_TRUE(((given.values - finer).array().abs() <= given.errors.array()).all());
}

TEST(BoundaryElements, SayWhenTheErrorWasNotReached) {
  Scene plates = plate_above_sensor(), cone = plate_above_sensor();
  cone.objects[0].shape = Cone{0.02, 0.02, 8};
  for (const auto& [scene, unknowns] : {std::pair(plates, 98U), std::pair(cone, 400U)}) {
    const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-5, .most_unknowns = unknowns});
    EXPECT_FALSE(answer.reached);
    EXPECT_LE(answer.unknowns, unknowns);
    EXPECT_GT((answer.errors.array() / answer.values.array().abs()).maxCoeff(), 1e-5);
  }
}

TEST(BoundaryElements, OfMeshesWhoseNeighboursOverlapAreSolved) {
  // Squares, each divided by either diagonal: four triangles, one of which depends on the others. So many
  // triangles are grouped with their neighbours.
  std::vector<Triangle> triangles;
  for (int x = 0; x < 11; ++x)
    for (int y = 0; y < 11; ++y) {
      const Vector3d a = 0.005 * Vector3d(x, y, 0), b = a + Vector3d(0.005, 0, 0),
                     c = b + Vector3d(0, 0.005, 0), d = a + Vector3d(0, 0.005, 0);
      for (const Triangle& triangle :
           {Triangle{a, b, c}, Triangle{a, c, d}, Triangle{a, b, d}, Triangle{b, c, d}})
        triangles.push_back(triangle);
    }
  const detail::ChargedBodies bodies = detail::charged_bodies(above_sensor({mesh(triangles)}));
  detail::PanelSystem system(bodies, {.missing = 0.01, .most_panels = 5000});
  system.refine({{5, 5}}, 4e-7);
  EXPECT_TRUE(system.solve(1e-4).positive_definite);
}

TEST(BoundaryElements, OfConductorsThatShieldOthersEndRefinement) {
  // An open mesh does not contain the box, which is grounded by itself; its entry beside the sensor's
  // vanishes, so that no error of it is small relative to it.
  std::vector<Triangle> housing = angle_iron(0.06, 0.05, 0.02);
  const MaxwellMatrix alone = maxwell(above_sensor({mesh(housing)}), {.rtol = 3e-3});
  std::swap(housing[0][0], housing[0][1]);
  const MaxwellMatrix answer =
      maxwell(above_sensor({mesh(housing), box("inside", {1, 0.5, 0.5}, {2, 1.5, 1.5})}), {.rtol = 3e-1});
  ASSERT_EQ(answer.values.rows(), 3);
  EXPECT_TRUE(answer.reached);
  EXPECT_LE(std::abs(answer.values(0, 2)), answer.errors(0, 2));
  EXPECT_LE(answer.errors(0, 2), 3e-1 * 1e-3 * std::sqrt(answer.values(0, 0) * answer.values(2, 2)));
  for (const Eigen::Index k : {0, 1})
    EXPECT_LE(std::abs(answer.values(0, k) - alone.values(0, k)), answer.errors(0, k) + alone.errors(0, k));
}

TEST(BoundaryElements, HaveTheSameBitsForAnyNumberOfThreads) {
  Scene scene = plate_above_sensor();
  scene.objects = {object("ball", Sphere{0.03, 24}, at(0, 0, 0.05))};
  const MaxwellMatrix one = maxwell(scene, {.rtol = 1e-2, .threads = 1});
  const MaxwellMatrix three = maxwell(scene, {.rtol = 1e-2, .threads = 3});
  EXPECT_EQ(one.values, three.values);
  EXPECT_EQ(one.errors, three.errors);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
