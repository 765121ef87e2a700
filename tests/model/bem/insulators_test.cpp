#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bem/double_layer.hpp"
#include "bem/film_sheets.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/error.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using namespace test;

constexpr double unit = 4 * std::numbers::pi * vacuum_permittivity;

const BoundaryElementOptions loose{.rtol = 1e-2};

/// Returns the first entry of the Maxwell matrix over 4πε, in metres.
double first_entry(const Scene& scene, double rtol) {
  return maxwell(scene, {.rtol = rtol}).values(0, 0) / unit;
}

/// Returns what the entry tends to for round surfaces: the errors by their facets fall like the square of the
/// number of segments.
template <typename MakeScene>
double of_round_surfaces(const MakeScene& scene, int few, int many, double rtol = 1e-2) {
  const double a = first_entry(scene(few), rtol), b = first_entry(scene(many), rtol);
  return (many * many * b - few * few * a) / (many * many - few * few);
}

TEST(Insulators, ABallOfPermittivityFiveBeforeAGroundedBallAgreesWithTheMultipoleSeries) {
  // The series of analysis/topics/verification/truths.py, two_balls(0.01, 0.02, 0.05,
  // dielectric(5)).
  constexpr double series = 0.010089173460725371;
  const auto scene = [](int segments) {
    Scene result;
    result.objects = {object("ball", Sphere{0.01, segments}, at(0, 0, 0)),
                      object("glass", Sphere{0.02, segments}, at(0, 0, 0.05), Dielectric{5})};
    return result;
  };
  // What 24 segments lack is added, and falls where panels are divided.
  const MaxwellMatrix fine = maxwell(scene(24), {.rtol = 1e-3});
  EXPECT_NEAR(fine.values(0, 0), series * unit, fine.errors(0, 0));
  EXPECT_LE(fine.errors(0, 0), 1e-3 * series * unit);
  // The stated error contains the facets of fewer segments.
  const MaxwellMatrix coarse = maxwell(scene(16), {.rtol = 2e-2});
  EXPECT_NEAR(coarse.values(0, 0), series * unit, coarse.errors(0, 0));
  EXPECT_LE(coarse.errors(0, 0), 0.06 * series * unit);
}

TEST(Insulators, BallsOfFewSegmentsChangeABallAsRoundOnesDoWithinTheirErrors) {
  struct Ball {
    Eigen::Isometry3d pose;
    double permittivity;
    double series;         ///< the capacitance beside it, of the same series
    double largest_error;  ///< relative
  };
  constexpr double rtol = 0.05;
  // The panels of the first two follow the shape, without cracks, which would charge the second one. The box
  // of the third one meets that of the first ball.
  for (const Ball& ball : {Ball{at(0, 0, 0.05), 5, 0.010089173460725371, 0.05},
                           Ball{at(0, 0, 0.05), 1000, 0.010154794557804546, 0.05},
                           Ball{at(0.0185, 0.0185, 0.0185), 30, 0.011498724334794083, 0.3}}) {
    Scene scene;
    scene.objects = {object("ball", Sphere{0.01, 8}, at(0, 0, 0), Electrode{}),
                     target(object("glass", Sphere{0.02, 8}, ball.pose, Dielectric{ball.permittivity}))};
    scene.readings = {{"ball", "ball", {"ball"}}};
    const Estimate change = maxwell(scene, {.rtol = rtol}).readings.at(0).change;
    const double truth = (ball.series - 0.01) * unit;
    EXPECT_NEAR(change.value.value(), truth, change.error.value()) << ball.permittivity;
    EXPECT_LT(change.error.value(), ball.largest_error * truth) << ball.permittivity;
  }
}

void expect_capacitance_of_coated_ball(double outer, double permittivity) {
  constexpr double radius = 0.01;
  const auto scene = [=](int segments) {
    Scene result;
    result.objects = {object("coat", Sphere{outer, segments}, at(0, 0, 0), Dielectric{permittivity}),
                      object("ball", Sphere{radius, segments}, at(0, 0, 0))};
    return result;
  };
  const double exact = 1 / ((1 / radius - 1 / outer) / permittivity + 1 / outer);
  EXPECT_NEAR(of_round_surfaces(scene, 16, 24), exact, 1e-3 * exact);
}

TEST(Insulators, ACoatedBallHasTheCapacitanceOfTwoInSeries) {
  expect_capacitance_of_coated_ball(0.02, 5);
  // A wet film of a five hundredth of the ball.
  expect_capacitance_of_coated_ball(0.01002, 80);
}

/// Expects the capacitance of a disc of 5 cm inside a confocal spheroid. The potential of a charged disc is
/// constant on confocal spheroids, arccot(half thickness/radius) outside (Landau and Lifshitz,
/// Electrodynamics of Continuous Media, § 4); so the layers' capacitances are in series.
void expect_capacitance_of_coated_disc(double half_thickness, double permittivity, double tolerance) {
  constexpr double radius = 0.05;
  const auto scene = [=](int segments) {
    const double wide = std::hypot(radius, half_thickness);
    Scene result;
    result.objects = {object("coat", Ellipsoid{wide, wide, half_thickness, segments}, at(0, 0, 0),
                             Dielectric{permittivity}),
                      object("disc", Disc{radius, segments}, at(0, 0, 0), Electrode{})};
    return result;
  };
  const double outside = std::atan2(radius, half_thickness);
  const double exact = radius / ((std::numbers::pi / 2 - outside) / permittivity + outside);
  EXPECT_NEAR(of_round_surfaces(scene, 24, 32, 3e-3), exact, tolerance * exact);
}

TEST(Insulators, ADiscInAFlatSpheroidHasTheCapacitanceOfConfocalLayers) {
  expect_capacitance_of_coated_disc(0.005, 4, 1e-3);
}

TEST(InsulatorsAtLength, ADiscInAWetFilmHasTheCapacitanceOfConfocalLayers) {
  // Asked to 3e-3; that of another refinement differs by up to a third of it.
  expect_capacitance_of_coated_disc(0.05 / 30, 80, 2e-3);
}

/// Returns a square sensor of 10 cm below a grounded box, with other bodies.
Scene below_a_box(const std::vector<Object>& others) {
  Scene scene = scene_of(square(0.1, 0), others);
  scene.objects.push_back(box("hand", {-5, -5, 3}, {5, 5, 6}));
  return scene;
}

TEST(Insulators, ALayerOfTheMediumOnASensorChangesNothing) {
  const MaxwellMatrix bare = maxwell(below_a_box({}), loose);
  const MaxwellMatrix covered =
      maxwell(below_a_box({box("glass", {-5, -5, 0}, {5, 5, 0.2}, Dielectric{1})}), loose);
  EXPECT_TRUE(covered.reached);
  EXPECT_LE((covered.values - bare.values).cwiseAbs().maxCoeff(), (covered.errors + bare.errors).maxCoeff());
}

TEST(Insulators, AMachineOfManyTrianglesBesideACoveredSensorIsSimplified) {
  constexpr int segments = 80;
  const Scene scene = scene_of(square(0.06, 0.16), {object("machine", Sphere{0.15, segments}, at(0, 0, 0)),
                                                    box("cover", {-3, -3, 16}, {3, 3, 16.2}, Dielectric{3}),
                                                    target(box("hand", {-2.5, -4, 21}, {2.5, 4, 23}))});
  const MaxwellMatrix found = maxwell(scene, {.rtol = 0.03});
  EXPECT_TRUE(found.reached);
  // Its triangles alone are more.
  EXPECT_LT(found.unknowns, std::size_t{segments * segments});
}

TEST(Insulators, OfBodiesThatOverlapTheLaterOneFillsTheCommonSpace) {
  const MaxwellMatrix one =
      maxwell(below_a_box({box("glass", {-4, -4, 0}, {4, 4, 1}, Dielectric{3})}), loose);
  const Object lower = box("covered", {-4, -4, 0}, {4, 4, 0.8}, Dielectric{7});
  const MaxwellMatrix two =
      maxwell(below_a_box({lower, box("glass", {-4, -4, 0}, {4, 4, 1}, Dielectric{3})}), loose);
  EXPECT_TRUE(covers(one, two));
}

TEST(Insulators, OneBesideABodyOfManyTrianglesIsAnswered) {
  Scene scene = below_a_box({box("glass", {-3, -3, 0}, {3, 3, 0.2}, Dielectric{3})});
  const MaxwellMatrix few = maxwell(scene, loose);
  Object& body = scene.objects.back();
  std::vector<Triangle> triangles = triangulate(std::get<Cuboid>(body.shape));
  // 12,288 triangles, more than there may be panels.
  for (int times = 0; times < 5; ++times) {
    std::vector<Triangle> finer;
    for (const Triangle& triangle : triangles)
      for (const Triangle& quarter : detail::quarters(triangle))
        finer.push_back(quarter);
    triangles = std::move(finer);
  }
  body.shape = Mesh{"", 1, triangles};
  const MaxwellMatrix many = maxwell(scene, {.rtol = 1e-2, .most_unknowns = 9000});
  EXPECT_NEAR(many.values(0, 0), few.values(0, 0), many.errors(0, 0) + few.errors(0, 0));
  EXPECT_LE(many.errors(0, 0), 0.03 * few.values(0, 0));
}

TEST(Insulators, AnswersDoNotDependOnTheNumberOfThreads) {
  const Scene scene = below_a_box({target(box("glass", {-5, -5, 1.5}, {5, 5, 2.5}, Dielectric{4}))});
  // So many panels that their equations are solved by iteration.
  const MaxwellMatrix one = maxwell(scene, {.rtol = 1e-3, .most_unknowns = 1300, .threads = 1});
  const MaxwellMatrix three = maxwell(scene, {.rtol = 1e-3, .most_unknowns = 1300, .threads = 3});
  EXPECT_EQ(one.unknowns, 1300U);
  EXPECT_EQ(one.values, three.values);
  EXPECT_EQ(one.readings.at(0).change.value, three.readings.at(0).change.value);
}

TEST(Insulators, ASlabCloseToASensorIsWithinItsErrorHoweverCoarseThePanels) {
  // In the first panels, the errors by charges and by potentials along the slab nearly cancel. Field solver:
  // 0.118269 ± 0.000116 pF.
  const Scene scene =
      scene_of(square(0.08, 0), {target(box("glass", {-5, -5, 0.8}, {5, 5, 1.2}, Dielectric{4}))});
  for (const double rtol : {0.3, 0.2, 0.1, 0.05}) {
    const MaxwellMatrix found = maxwell(scene, {.rtol = rtol});
    EXPECT_TRUE(found.reached) << rtol;
    EXPECT_FALSE(found.lower_bounds[0]);
    EXPECT_NEAR(*found.readings[0].change.value, 0.1183e-12, *found.readings[0].change.error) << rtol;
    EXPECT_NEAR(found.delta_self[0], 0.1183e-12, found.delta_self_errors[0]) << rtol;
  }
}

/// A plate of 2 cm in the middle of others at its potential, of 6 cm together, between grounded plates 5 mm
/// above and below, with a layer on both of its sides.
Scene guarded_condenser(double layer, double permittivity) {
  constexpr double outer = 0.03, gap = 0.005;
  Scene scene;
  const auto add = [&](int column, int row) {
    scene.objects.push_back(object("plate" + std::to_string(3 * column + row), Plate{0.02, 0.02},
                                   at(0.02 * column, 0.02 * row, 0), Electrode{}));
    scene.objects.back().conductor = "plates";
  };
  add(0, 0);
  for (const int column : {-1, 0, 1})
    for (const int row : {-1, 0, 1})
      if (column != 0 || row != 0)
        add(column, row);
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "upper" : "lower";
    scene.objects.push_back(object(name, Plate{2 * outer, 2 * outer}, at(0, 0, side * gap)));
    scene.objects.push_back(object(name + " layer", Cuboid{2 * outer, 2 * outer, layer},
                                   at(0, 0, side * layer / 2), Dielectric{permittivity}));
  }
  return scene;
}

TEST(Insulators, AGuardedCondenserFilledInLayersHasTheCapacitanceOfTheirSeries) {
  const MaxwellMatrix found = maxwell(guarded_condenser(0.002, 4), {.rtol = 0.01});
  const double exact = 2 * vacuum_permittivity * 0.02 * 0.02 / (0.002 / 4 + 0.003);
  EXPECT_NEAR(found.charges(0, 0), exact, 1e-4 * exact);
}

/// Expects the capacitance of a sensor with a film of 14 cm on it: beside the sensor the potential falls
/// along the film.
void expect_capacitance_below_film(double centimetres, double permittivity, double expected,
                                   double accuracy) {
  const MaxwellMatrix film =
      maxwell(below_a_box({box("glass", {-7, -7, 0}, {7, 7, centimetres}, Dielectric{permittivity})}), loose);
  EXPECT_NEAR(film.values(0, 0), expected, film.errors(0, 0));
  EXPECT_LE(film.errors(0, 0), accuracy * expected);
}

TEST(InsulatorsAtLength, AFilmAroundASensorAgreesWithTheFieldSolver) {
  // python3 -m fem_reference SCENE --rtol 1e-2 --error estimate: (7.4452 ± 0.0024) pF.
  expect_capacitance_below_film(0.05, 16.8, 7.4452e-12, 0.02);
}

TEST(Insulators, AThinFilmAroundASensorIsASheet) {
  // Layers of 1 mm and 8.9 and of 0.5 mm and 16.8, with equal strength, have 7.4911 and 7.4452 pF by the
  // field solver: 0.1 mm has this.
  expect_capacitance_below_film(0.01, 80, 7.4085e-12, 0.01);
}

TEST(Insulators, OneFarAwayLeavesTheErrorOfRoundBodiesBeforeANarrowGap) {
  // Two coins a twentieth of their height apart, polygons of 12 sides, which lack 4.5 % of the area. Alone
  // they are solved as round.
  Scene scene;
  scene.objects = {object("a", Cylinder{0.01, 0.002, 12}, at(0, 0, 0), Electrode{}),
                   object("b", Cylinder{0.01, 0.002, 12}, at(0, 0, 0.0021), Electrode{})};
  const MaxwellMatrix alone = maxwell(scene, loose);
  ASSERT_TRUE(alone.reached);
  scene.objects.push_back(box("glass", {6, 0, 0}, {7, 1, 1}, Dielectric{4}));
  const MaxwellMatrix beside = maxwell(scene, loose);
  EXPECT_LE(std::abs(beside.values(0, 0) - alone.values(0, 0)), beside.errors(0, 0) + alone.errors(0, 0));
}

TEST(Insulators, OneFarAwayLeavesTheErrorOfLongTrianglesAsItIs) {
  // The round cylinder by the field solver: python3 -m fem_reference SCENE --rtol 1e-3, (1.48297 ± 0.00020)
  // pF.
  constexpr double field = 1.48297e-12;
  Scene scene;
  scene.objects = {object("coin", Cylinder{0.02, 0.001, 128}, at(0, 0, 0), Electrode{}),
                   object("far", Cuboid{0.01, 0.01, 0.03}, at(0, 0, 0.2), Dielectric{2})};
  const MaxwellMatrix found = maxwell(scene, loose);
  EXPECT_NEAR(found.values(0, 0), field, found.errors(0, 0));
  EXPECT_LE(found.errors(0, 0), 0.03 * field);
}

/// Holds what a body of very high permittivity changes against what it changes as a floating conductor.
void expect_like_a_floating_conductor(const Object& body, double permittivity) {
  Scene scene = scene_of(square(0.1, 0), {target(body)});
  scene.objects[0].role = Floating{};
  const MaxwellMatrix floating = maxwell(scene, loose);
  scene.objects[0].role = Dielectric{permittivity};
  const MaxwellMatrix found = maxwell(scene, {.rtol = 0.1});
  const Estimate &one = floating.readings[0].change, &other = found.readings[0].change;
  EXPECT_NEAR(*other.value, *one.value, *one.error + *other.error);
  EXPECT_LE(*other.error, 0.1 * *one.value);
  EXPECT_NEAR(found.values(0, 0), floating.values(0, 0), found.errors(0, 0) + floating.errors(0, 0));
}

TEST(Insulators, OneOfVeryHighPermittivityIsAFloatingConductor) {
  for (const double permittivity : {1e4, 1e6})
    expect_like_a_floating_conductor(box("block", {-3, -4, 3}, {7, 6, 13}), permittivity);
  expect_like_a_floating_conductor(
      object("rounded", RoundedCuboid{0.04, 0.14, 0.07, 0.01, 24}, at(0, 0, 0.06)), 1e6);
}

TEST(Insulators, WhatARoundOneChangesIsReachedAsIsTheCapacitanceOfThePlate) {
  // Its panels follow the shape, and the plate, whose charge the change follows too, is refined with them.
  const Object tin = object("tin", Cylinder{0.05, 0.03, 48}, at(0, 0, 0.12), Dielectric{3});
  const MaxwellMatrix found = maxwell(scene_of(square(0.06, 0), {target(tin)}), loose);
  EXPECT_TRUE(found.reached);
  // The capacitance of a square plate by itself is 0.366788 times 4πε and its side (HierBEM).
  const Estimate& plate = found.readings[0].background;
  EXPECT_NEAR(*plate.value, 0.366788 * 0.06 * unit, *plate.error);
}

TEST(Insulators, AFlatSpheroidDoesNotLoseItsSolutionWherePanelsAreDivided) {
  const Object lens = object("lens", Ellipsoid{0.05, 0.05, 0.002, 48}, at(0, 0, 0.04), Dielectric{50});
  const Estimate change =
      maxwell(scene_of(square(0.06, 0), {target(lens)}), {.rtol = 0.2}).readings[0].change;
  EXPECT_LE(*change.error, 0.3 * *change.value);
}

TEST(FilmSheets, AStripBetweenTwoConductorsHasTheCapacitanceOfItsLengthWhateverItsPanels) {
  // Two panels, and beside them three, one corner of which lies on a side of the former.
  const Eigen::Vector3d a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0), e(2, 0, 0), f(2, 1, 0),
      middle(1, 0.4, 0);
  constexpr double strength = 0.3;
  std::vector<detail::SheetPanel> panels;
  for (const Triangle& triangle : {Triangle{a, b, c}, Triangle{a, c, d}, Triangle{b, e, middle},
                                   Triangle{middle, e, f}, Triangle{middle, f, c}})
    panels.push_back({triangle, strength, 0.001});
  const auto ends = [](const Eigen::Vector3d& corner) -> std::optional<std::size_t> {
    if (corner.x() == 0)
      return 0;
    if (corner.x() == 2)
      return 1;
    return std::nullopt;
  };
  const detail::FilmSheets film(panels, ends, 2);
  const double exact = strength / (4 * std::numbers::pi) / 2;
  EXPECT_NEAR(film.direct()(0, 0), exact, 1e-4 * exact);
  EXPECT_NEAR(film.direct()(0, 1), -exact, 1e-4 * exact);
  EXPECT_NEAR(film.lifts()(0, 0), 1 - (0 + 1 + 1) / 6.0, 1e-4);
  EXPECT_NEAR(film.lifts()(2, 1), (1 + 2 + 1) / 6.0, 1e-4);
}

TEST(Insulators, OneInsideAConductorIsRefused) {
  const Scene scene = below_a_box({box("glass", {-1, -1, 4}, {1, 1, 5}, Dielectric{4})});
  EXPECT_THAT([&] { maxwell(scene, loose); },
              testing::ThrowsMessage<InputError>(
                  testing::HasSubstr(R"(object "glass" is dielectric and wholly inside a conductor)")));
}

TEST(DoubleLayer, TheFacesOfABodyAddUpToTheWholeSolidAngle) {
  std::vector<detail::Panel> panels;
  for (const Triangle& triangle : triangulate(Cuboid{1, 2, 0.1}))
    panels.push_back(detail::make_panel(triangle));
  const std::vector<bool> all(panels.size(), true);
  const Eigen::MatrixXd matrix = detail::double_layer_of(panels, panels, all, 1e-5, {{}, {}}, 1).elements;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    EXPECT_NEAR(matrix.row(row).sum(), 0.5, 1e-4);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
