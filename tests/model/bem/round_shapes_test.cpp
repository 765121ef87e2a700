/// Tests round shapes against closed forms: panels follow them, or the stated errors contain their facets.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "bem/panel_mesh.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/triangle.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "surface/round_shape.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::RoundShape;
using test::at;
using test::object;

constexpr double pi = std::numbers::pi;
constexpr double unit = 4 * pi * vacuum_permittivity;

TEST(RoundShapes, MakeNoSliversOfATriangleOnAGreatCircle) {
  // The middle of the long side would go to the third corner.
  const auto on_circle = [](double angle) { return Eigen::Vector3d(std::cos(angle), std::sin(angle), 0); };
  const std::vector<Triangle> fin{{on_circle(-0.3), on_circle(0.3), on_circle(0)}};
  const auto ball = RoundShape::of(Sphere{1, 16}, Eigen::Isometry3d::Identity());
  detail::PanelMesh mesh;
  mesh.add(0, fin, {}, &*ball);
  for (int level = 0; level < 2; ++level)
    mesh.refine(std::vector<int>(mesh.groups().size(), 3),
                Eigen::MatrixXd::Ones(detail::index_of(mesh.panels().size()), 1));
  double least = twice_area(fin[0]) / 2;
  for (const detail::Panel& panel : mesh.panels())
    least = std::min(least, panel.area);
  // Each of six halvings and the division into quarters gives a part at least a fifth of its share.
  EXPECT_GT(least, std::pow(0.2, 7) * twice_area(fin[0]) / 2 / 256);
}

TEST(RoundShapes, DividedPanelsHaveTheirCornersOnTheShape) {
  for (const Shape& shape :
       std::vector<Shape>{Sphere{0.02, 12}, Ellipsoid{0.03, 0.02, 0.01, 12}, Capsule{0.02, 0.03, 12},
                          RoundedCuboid{0.03, 0.02, 0.04, 0.005, 12}, Disc{0.02, 12},
                          Cylinder{0.02, 0.03, 12}, Cone{0.02, 0.03, 12}, Arc{0.02, 0.03, 0.01, 120, 12}}) {
    const auto round = RoundShape::of(shape, Eigen::Isometry3d::Identity());
    detail::PanelMesh mesh;
    mesh.add(0, triangulate(shape), {}, &*round);
    for (int level = 0; level < 2; ++level)
      mesh.refine(std::vector<int>(mesh.groups().size(), 1),
                  Eigen::MatrixXd::Ones(detail::index_of(mesh.panels().size()), 1));
    for (const detail::Panel& panel : mesh.panels())
      for (const Eigen::Vector3d& corner : panel.corners)
        EXPECT_LT((round->on_shape(corner) - corner).norm(), 2e-14) << shape.index();
  }
}

TEST(RoundShapes, TwoBallsHaveTheCapacitancesOfTheSeriesOfImages) {
  // Lekner 2011: balls of 1 and 2 cm, 5 cm apart, in pF.
  const Eigen::Matrix2d exact{{1.2305175015, -0.4945667562}, {-0.4945667562, 2.4315431141}};
  Scene scene;
  scene.objects = {object("small", Sphere{0.01, 12}, at(0, 0, 0), Electrode{}),
                   object("large", Sphere{0.02, 20}, at(0.05, 0, 0), Electrode{})};
  const MaxwellMatrix found = maxwell(scene, {.rtol = 3e-3});
  EXPECT_TRUE(found.reached);
  for (Eigen::Index row = 0; row < 2; ++row)
    for (Eigen::Index column = 0; column < 2; ++column)
      EXPECT_NEAR(1e12 * found.values(row, column), exact(row, column), 1e12 * found.errors(row, column));
  EXPECT_FALSE(found.lower_bounds[0]) << "what the facets lack is added";
}

TEST(RoundShapes, AnswersDoNotDependOnTheSegments) {
  const auto answer = [](const Shape& shape) {
    Scene scene;
    scene.objects = {object("body", shape, at(0, 0, 0), Electrode{})};
    return maxwell(scene, {.rtol = 5e-3});
  };
  // The walls of the arc are closer to each other than its sides are to the round walls.
  const std::vector<std::pair<Shape, Shape>> shapes = {
      {RoundedCuboid{0.08, 0.1, 0.03, 0.012, 12}, RoundedCuboid{0.08, 0.1, 0.03, 0.012, 32}},
      {Arc{0.0295, 0.03, 0.03, 100, 3}, Arc{0.0295, 0.03, 0.03, 100, 24}}};
  for (const auto& [of_few, of_many] : shapes) {
    const MaxwellMatrix few = answer(of_few), many = answer(of_many);
    EXPECT_TRUE(few.reached);
    EXPECT_NEAR(few.values(0, 0), many.values(0, 0), few.errors(0, 0) + many.errors(0, 0));
  }
}

TEST(RoundShapes, BodiesOfFewSegmentsHaveTheCapacitancesOfTheRoundOnes) {
  struct Known {
    Shape shape;
    double rtol;
    double capacitance;  ///< F
    double known_to;     ///< relative to it
  };
  // The disc and the spheroid, e/asin(e), in closed form; the others by the field solver on the round bodies.
  const std::vector<Known> known = {{Disc{0.1, 12}, 5e-3, 2 / pi * 0.1 * unit, 0},
                                    {Ellipsoid{0.1, 0.1, 0.05, 16}, 2e-3, 0.8269933431 * 0.1 * unit, 0},
                                    {Cylinder{0.05, 0.1, 12}, 1e-2, 6.6286e-12, 6e-4},
                                    {Cylinder{0.1, 0.01, 12}, 1e-2, 7.6717e-12, 6e-4},
                                    {Cone{0.05, 0.1, 12}, 1e-2, 4.8563e-12, 6e-4},
                                    {Arc{0.03, 0.05, 0.01, 360, 12}, 1e-2, 3.9939e-12, 6e-4},
                                    {Arc{0.03, 0.05, 0.01, 120, 12}, 1e-2, 2.3547e-12, 6e-4},
                                    {Arc{0.0495, 0.05, 0.1, 360, 6}, 1e-2, 6.4188e-12, 2e-4}};
  for (const auto& [shape, rtol, capacitance, known_to] : known) {
    Scene scene;
    scene.objects = {object("body", shape, at(0, 0, 0), Electrode{})};
    const MaxwellMatrix found = maxwell(scene, {.rtol = rtol});
    EXPECT_TRUE(found.reached) << capacitance;
    EXPECT_NEAR(found.values(0, 0), capacitance, found.errors(0, 0) + known_to * capacitance);
  }
}

TEST(RoundShapes, PanelsWithoutChargesAreHalvedAcrossTheirLongestSides) {
  const Cylinder rod{0.01, 1, 12};
  const auto round = RoundShape::of(rod, Eigen::Isometry3d::Identity());
  detail::PanelMesh mesh;
  mesh.add(0, triangulate(rod), {}, &*round);
  for (int level = 0; level < 4; ++level)
    mesh.refine(std::vector<int>(mesh.groups().size(), 1),
                Eigen::MatrixXd(detail::index_of(mesh.panels().size()), 0));
  double longest = 0;
  for (const detail::Panel& panel : mesh.panels())
    longest = std::max(longest, 2 * panel.radius);
  EXPECT_LT(longest, 0.25) << "a quarter of the quarters' half metre, and what the centre is off";
}

TEST(RoundShapes, PanelsOfFewSegmentsAreHalvedAlongTheCurve) {
  // Were sides chosen by the charges alone, this would take six times as many panels.
  Scene scene =
      test::scene_of(test::square(0.1, 0), {object("a", Cone{0.05, 0.1, 6}, at(0, 0, 0.07)),
                                            object("b", Cylinder{0.05, 0.1, 12}, at(0.15, 0, 0.07))});
  const BoundaryElementOptions options{.rtol = 5e-3, .entries = Entries::of_sensors};
  const MaxwellMatrix few = maxwell(scene, options);
  EXPECT_TRUE(few.reached);
  EXPECT_LT(few.unknowns, 8000U);
  scene.objects[0].shape = Cone{0.05, 0.1, 48};
  scene.objects[1].shape = Cylinder{0.05, 0.1, 48};
  const MaxwellMatrix many = maxwell(scene, options);
  EXPECT_TRUE(test::covers(few, many));
}

TEST(RoundShapes, TheErrorOfAChangeContainsTheRoundTarget) {
  // Series of images: a ball of 1 cm, grounded, with its centre 3 cm above that of a driven one of 1 cm.
  // Capacitances over 4πε in units of the radius (gap of one radius): 1.1462874419 − 1.
  Scene scene;
  scene.objects = {object("driven", Sphere{0.01, 20}, at(0, 0, 0), Electrode{}),
                   test::target(object("target", Sphere{0.01, 20}, at(0, 0, 0.03)))};
  scene.readings = {{"self", "driven", {"driven"}}};
  const MaxwellMatrix found = maxwell(scene, {.rtol = 5e-3});
  const double exact = 0.1462874419 * 0.01 * unit;
  ASSERT_EQ(found.readings.size(), 1U);
  EXPECT_NEAR(*found.readings[0].change.value, exact, *found.readings[0].change.error);
  EXPECT_LE(*found.readings[0].change.error, 0.2 * exact);
}

TEST(RoundShapes, TheErrorOfTheChangeByAFlatConeContainsTheRoundOne) {
  // At a sharp rim, Hadamard's formula finds half of what the facets of the polyhedron cost.
  const Object cone = object("cone", Cone{0.0333, 0.0108, 12}, at(0, 0, 0.1));
  const Scene scene = test::scene_of(test::square(0.08, 0), {test::target(cone)});
  const MaxwellMatrix found = maxwell(scene, {.rtol = 3e-2});
  ASSERT_EQ(found.readings.size(), 1U);
  // The field solver on the round cone, in pF, to 1e-3.
  EXPECT_NEAR(1e12 * *found.readings[0].change.value, 0.20018, 1e12 * *found.readings[0].change.error);
  EXPECT_LE(*found.readings[0].change.error, 3e-2 * *found.readings[0].change.value);
}

TEST(RoundShapes, TheErrorBeforeANarrowGapContainsTheAreaThatThePolygonsLack) {
  // Kirchhoff's formula for two coins of radius r and thickness t at a distance d; the polygons of 12 sides
  // that begin lack 4.5 % of their faces.
  const double r = 7e-3, t = 1e-3, d = 1e-5;
  const double kirchhoff =
      vacuum_permittivity *
      (pi * r * r / d + r * (std::log(16 * pi * r * (d + t) / (d * d)) - 1 + t / d * std::log(1 + d / t)));
  Scene scene;
  scene.objects = {object("a", Cylinder{r, t, 12}, at(0, 0, 0), Electrode{}),
                   object("b", Cylinder{r, t, 12}, at(0, 0, t + d), Electrode{})};
  for (const double rtol : {1e-1, 1e-2}) {
    const MaxwellMatrix found = maxwell(scene, {.rtol = rtol});
    EXPECT_TRUE(found.reached);
    EXPECT_NEAR((found.values(0, 0) - found.values(0, 1)) / 2, kirchhoff, found.errors(0, 0)) << rtol;
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
