#include "fringe/capacitance.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::at;
using test::object;

Object plate_at(const std::string& name, double size, double height) {
  return object(name, Plate{size, size}, at(0, 0, height));
}

/// Returns the plate as a mesh, which has one outward side, up.
Object sheet_at(const std::string& name, double size, double height) {
  return object(name, Mesh{"", 1, triangulate(Plate{size, size})}, at(0, 0, height));
}

/// Returns a scene with a sensor of 10 cm × 10 cm and plates of the same size 2 cm in front of it and 4 cm
/// behind it.
Scene sandwich() {
  return test::scene_of(test::square(0.1, 0), {plate_at("near", 0.1, 0.02), plate_at("behind", 0.1, -0.04)});
}

TEST(Capacitance, OfParallelPlatesIsPermittivityTimesAreaOverDistance) {
  Scene scene = sandwich();
  scene.medium.relative_permittivity = 2;
  const SensorCapacitance felt = capacitance(scene).sensors.at(0);
  // C = ε₀·ε_r·A/d
  const double near = 8.8541878128e-12 * 2 * 0.01 / 0.02, behind = 8.8541878128e-12 * 2 * 0.01 / 0.04;
  EXPECT_EQ(felt.name, "front");
  EXPECT_EQ(felt.objects.at(0).name, "near");
  EXPECT_DOUBLE_EQ(felt.objects.at(0).capacitance, near);
  EXPECT_DOUBLE_EQ(felt.objects.at(1).capacitance, behind);
  EXPECT_DOUBLE_EQ(felt.total, near + behind);
  EXPECT_EQ(felt.objects.at(0).bound, 0);
  EXPECT_FALSE(felt.objects.at(0).skipped);
  EXPECT_FALSE(felt.contact);
}

TEST(Capacitance, AddsUpOverThePlatesOfASensor) {
  Scene scene = sandwich();
  const double one = capacitance(scene).sensors.at(0).total;
  scene.sensors[0].plates.push_back(scene.sensors[0].plates[0]);
  EXPECT_DOUBLE_EQ(capacitance(scene).sensors.at(0).total, 2 * one);
}

TEST(Capacitance, OfEveryShapeFollowsTheTreeOfLinks) {
  const Triangle triangle{Vector3d{0, 0, 0}, {0.05, 0, 0.01}, {0, 0.05, 0.02}};
  const std::vector<Shape> shapes{
      Plate{0.05, 0.1},     Cuboid{0.05, 0.05, 0.05},     Cuboid{0.02, 0.04, 0.06}, Cylinder{0.02, 0.05, 12},
      Cone{0.03, 0.05, 12}, Arc{0.03, 0.05, 0.02, 90, 8}, Sphere{0.03, 12},         Mesh{"", 1, {triangle}}};
  const Eigen::Isometry3d arm = pose_from_axis({1, 0, 2}, 30, {1, 2, 3}),
                          hand = pose_from_axis({0, 1, 1}, -50, {0.1, 0, 0.2}),
                          own = pose_from_axis({1, 1, 0}, 20, {0.02, -0.01, 0.07});
  for (const Shape& shape : shapes) {
    Scene flat = sandwich();
    flat.objects = {object("thing", shape, own)};
    const double expected = capacitance(flat).sensors.at(0).total;
    EXPECT_GT(expected, 0);
    EXPECT_NEAR(capacitance(flat, {Split{6}}).sensors.at(0).total, expected, 1e-3 * expected);

    // First the object and the sensor are both attached to the hand, which is attached to the arm; then the
    // object is attached to the arm itself.
    Scene scene = flat;
    scene.links = {{"hand", 1, hand}, {"arm", std::nullopt, arm}};
    scene.sensors[0].link = 0;
    scene.objects[0].link = 0;
    EXPECT_NEAR(capacitance(scene).sensors.at(0).total, expected, 1e-12 * expected);
    scene.objects[0].link = 1;
    scene.objects[0].pose = hand * own;
    EXPECT_NEAR(capacitance(scene).sensors.at(0).total, expected, 1e-12 * expected);
    set_pose(scene, "hand", Eigen::Isometry3d::Identity());
    EXPECT_GT(std::abs(capacitance(scene).sensors.at(0).total - expected), 1e-3 * expected);
  }
}

TEST(Capacitance, WithoutObjectsIsZeroAndLeavesTheInputVoltage) {
  Scene scene = sandwich();
  scene.objects.clear();
  const SensorCapacitance felt = capacitance(scene).sensors.at(0);
  EXPECT_EQ(felt.total, 0);
  EXPECT_EQ(felt.voltage, 2.5);
  EXPECT_EQ(felt.delta_voltage, 0);
}

TEST(Capacitance, OnContactIsInfiniteAndLeavesNoVoltage) {
  Scene scene = sandwich();
  scene.objects.push_back(plate_at("touching", 0.02, 0));
  const SensorCapacitance felt = capacitance(scene).sensors.at(0);
  EXPECT_TRUE(felt.contact);
  EXPECT_EQ(felt.total, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(felt.objects.at(0).capacitance));
  EXPECT_EQ(felt.objects.at(2).capacitance, std::numeric_limits<double>::infinity());
  EXPECT_EQ(felt.voltage, 0);
  EXPECT_EQ(felt.delta_voltage, 2.5);
}

TEST(Capacitance, DividesTheVoltageAsTwoCapacitorsInSeries) {
  Sensor sensor;
  sensor.input_voltage = 3;
  sensor.coupling_capacitance = 2e-12;
  // V = C_c/(C_c + C)·V_in
  EXPECT_DOUBLE_EQ(divider_voltage(sensor, 4e-12), 1);
  EXPECT_DOUBLE_EQ(divider_voltage(sensor, 0), 3);
}

/// Returns the sandwich with its sensor divided into two adjacent plates, and with an additional ball.
Scene divided_sensor() {
  Scene scene = sandwich();
  scene.sensors[0].plates = {{{-0.05, -0.05, 0}, {0.04, 0, 0}, {0, 0.1, 0}},
                             {{-0.01, -0.05, 0}, {0.06, 0, 0}, {0, 0.1, 0}}};
  scene.objects.push_back(object("ball", Sphere{0.03, 12}, pose_from_axis({1, 2, 3}, 40, {0.01, 0.02, 0.1})));
  return scene;
}

const EvaluationOptions nearest{Exact{}, PlateRule::nearest};

TEST(Capacitance, OfTheNearestOfTwoTilesIsThatOfTheWholePlate) {
  Scene whole = divided_sensor();
  whole.sensors[0].plates = sandwich().sensors[0].plates;
  const SensorCapacitance expected = capacitance(whole).sensors.at(0);
  const SensorCapacitance felt = capacitance(divided_sensor(), nearest).sensors.at(0);
  for (std::size_t i = 0; i < expected.objects.size(); ++i)
    EXPECT_NEAR(felt.objects.at(i).capacitance, expected.objects.at(i).capacitance,
                1e-13 * expected.objects.at(i).capacitance);
  EXPECT_GT(capacitance(divided_sensor()).sensors.at(0).total, 1.5 * felt.total);
}

TEST(Capacitance, OfNodesGivesEachToItsNearestPlate) {
  const double exact = capacitance(divided_sensor(), nearest).sensors.at(0).total;
  for (const Method& method : {Method{Split{5}}, Method{Gauss{16}}}) {
    const double nodes = capacitance(divided_sensor(), {method, PlateRule::nearest}).sensors.at(0).total;
    EXPECT_NE(nodes, exact);
    EXPECT_NEAR(nodes, exact, 1e-3 * exact);
  }
}

TEST(Capacitance, OfNodesIsInfiniteOnContactWithAnyPlate) {
  Scene scene = divided_sensor();
  // The wall crosses the second plate, but no node of the sums lies on the plate.
  scene.objects = {object("wall", Plate{0.02, 0.02}, pose_from_axis({1, 0, 0}, 90, {0.02, 0, 0.001}))};
  for (const Method& method : {Method{Exact{}}, Method{Split{2}}, Method{Gauss{2}}})
    for (const PlateRule rule : {PlateRule::sum, PlateRule::nearest})
      EXPECT_TRUE(capacitance(scene, {method, rule}).sensors.at(0).contact);
}

TEST(Capacitance, OfFacingFacesLeavesOutTheBackOfABody) {
  Scene scene = sandwich();
  const double size = 0.1, gap = 0.02;
  scene.objects = {object("box", Cuboid{size, size, size}, at(0, 0, gap + size / 2))};
  // Only the face opposite the plate counts: not the back, and not the sides, whose planes contain the
  // plate's edges.
  const double front = vacuum_permittivity * size * size / gap;
  const SensorCapacitance facing =
      capacitance(scene, {Exact{}, PlateRule::sum, FaceRule::facing}).sensors.at(0);
  EXPECT_NEAR(facing.total, front, 1e-14 * front);
  // For all faces, add the back at gap + size and four sides with 4·size·∫dz/z.
  const double all =
      front + vacuum_permittivity * (size * size / (gap + size) + 4 * size * std::log((gap + size) / gap));
  EXPECT_NEAR(capacitance(scene).sensors.at(0).total, all, 1e-13 * all);
}

TEST(Capacitance, OfFacingFacesSeesTheFrontOfASheetOnly) {
  // Both sheets have their normal along +z: the one above the sensor faces away from it, the one below faces
  // it.
  Scene scene = sandwich();
  scene.objects = {sheet_at("near", 0.1, 0.02), sheet_at("behind", 0.1, -0.04)};
  const SensorCapacitance felt =
      capacitance(scene, {Exact{}, PlateRule::sum, FaceRule::facing}).sensors.at(0);
  EXPECT_EQ(felt.objects.at(0).capacitance, 0);
  EXPECT_DOUBLE_EQ(felt.objects.at(1).capacitance, vacuum_permittivity * 0.01 / 0.04);
}

TEST(Capacitance, OfFacingFacesCountsThatSideOfASheetThatFaces) {
  const Polygon triangle{{{-0.02, -0.02}, {0.03, -0.02}, {0, 0.04}}};
  for (const Shape& sheet : {Shape(Plate{0.1, 0.1}), Shape(Disc{0.03, 16}), Shape(triangle)})
    for (const PlateRule plates : {PlateRule::sum, PlateRule::nearest})
      for (const double degrees : {0, 70, 90, 180, 250}) {
        Scene scene = sandwich();
        scene.objects[0].shape = sheet;
        scene.objects[0].pose = pose_from_axis({1, 0, 0}, degrees, {0.01, 0.02, 0.08});
        const SensorCapacitance all = capacitance(scene, {Exact{}, plates}).sensors.at(0);
        const SensorCapacitance facing =
            capacitance(scene, {Exact{}, plates, FaceRule::facing}).sensors.at(0);
        EXPECT_GT(all.objects.at(0).capacitance, 0);
        for (const std::size_t object : {0, 1})
          EXPECT_EQ(facing.objects.at(object).capacitance, all.objects.at(object).capacitance) << degrees;
      }
}

TEST(Capacitance, OfFacingFacesIsInfiniteOnContactFromAnySide) {
  for (const PlateRule rule : {PlateRule::sum, PlateRule::nearest}) {
    Scene scene = divided_sensor();
    scene.objects = {sheet_at("lying", 0.02, 0)};
    EXPECT_TRUE(capacitance(scene, {Exact{}, rule, FaceRule::facing}).sensors.at(0).contact);
    // The object lies in the plate's plane beside the plate: it neither sees nor touches it.
    scene.objects[0].pose = at(0.2, 0, 0);
    EXPECT_EQ(capacitance(scene, {Exact{}, rule, FaceRule::facing}).sensors.at(0).total, 0);
  }
}

TEST(Capacitance, OfTheNearestFacingPlateLooksAmongThoseAFaceSees) {
  // The plate behind the object is nearer but not seen, so the one in front counts.
  Scene scene = sandwich();
  scene.objects = {sheet_at("between", 0.1, 0.06)};
  scene.sensors[0].plates.push_back({{-0.05, -0.05, 0.16}, {0.1, 0, 0}, {0, 0.1, 0}});
  const double below = vacuum_permittivity * 0.01 / 0.06, above = vacuum_permittivity * 0.01 / 0.1;
  for (const Method& method : {Method{Exact{}}, Method{Split{2}}}) {
    EXPECT_NEAR(capacitance(scene, {method, PlateRule::nearest}).sensors.at(0).total, below, 1e-14 * below);
    EXPECT_NEAR(capacitance(scene, {method, PlateRule::nearest, FaceRule::facing}).sensors.at(0).total, above,
                1e-14 * above);
  }
}

TEST(Capacitance, CountsTrianglesThatAMeshHasTwiceOnceAndThoseWithoutAreaNotAtAll) {
  Scene scene = sandwich();
  const Triangle triangle{Vector3d{0, 0, 0.03}, {0.1, 0, 0.04}, {0, 0.1, 0.05}};
  const Triangle turned{triangle[0], triangle[2], triangle[1]};
  const Triangle point{triangle[0], triangle[0], triangle[0]};
  const Triangle line{Vector3d{0, 0, 0}, {0.02, 0, 0}, {0.04, 0, 0}};
  const auto total = [&](const std::vector<Triangle>& triangles, const EvaluationOptions& options) {
    scene.objects = {object("mesh", Mesh{"", 1, triangles}, at(0, 0, 0))};
    return capacitance(scene, options).sensors.at(0).total;
  };
  for (const PlateRule plates : {PlateRule::sum, PlateRule::nearest})
    for (const FaceRule faces : {FaceRule::all, FaceRule::facing}) {
      const EvaluationOptions options{Exact{}, plates, faces};
      const double once = total({turned}, options);
      EXPECT_GT(once, 0);
      EXPECT_DOUBLE_EQ(total({turned, point, turned, line}, options), once);
      // The plate sees only one side of two that look in opposite directions.
      EXPECT_DOUBLE_EQ(total({triangle, turned}, options), once);
    }
}

void expect_refused(const Scene& scene, const EvaluationOptions& options, const std::string& reason) {
  EXPECT_THAT([&] { capacitance(scene, options); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr(reason)));
}

TEST(Capacitance, RefusesOptionsThatAreNoneOrChangeNothing) {
  for (const double tolerance : {-1e-9, std::numeric_limits<double>::infinity(), std::nan("")})
    expect_refused(sandwich(), {Exact{}, PlateRule::sum, FaceRule::all, tolerance}, "tolerance");
  for (const Method& method : {Method{Split{2}}, Method{Gauss{2}}})
    expect_refused(sandwich(), {method, PlateRule::sum, FaceRule::all, 1e-6}, "needs the method exact");
  expect_refused(sandwich(), {.method = Formula{}, .plates = PlateRule::nearest}, "");
  expect_refused(sandwich(), {.method = Formula{}, .faces = FaceRule::facing}, "");
  expect_refused(sandwich(), {.method = Formula{}, .tolerance = 1e-3}, "");
}

TEST(Capacitance, NamesTheElementThatIsWrong) {
  const Triangle good{Vector3d{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  Triangle bad = good;
  bad[2].y() = std::nan("");
  Scene scene = sandwich();
  scene.objects[1].shape = Mesh{"", 1, {good, bad}};
  expect_refused(scene, {}, "object \"behind\": triangle 1: vertex 2 is not finite");
  scene.objects[1].shape = Mesh{"", 1, {}};
  expect_refused(scene, {}, "object \"behind\" has no triangles");

  scene = divided_sensor();
  Vector3d& edge = scene.sensors[0].plates[1].edge_v;
  edge = {1e-9, 0.1, 0};
  expect_refused(scene, {}, "sensor \"front\": plates[1]: edge_u and edge_v are not at right angles");
  edge = {0, 0, 0};
  expect_refused(scene, {}, "sensor \"front\": plates[1]: a rectangle's edge must not have length zero");
  edge = {0, std::numeric_limits<double>::infinity(), 0};
  expect_refused(scene, {}, "sensor \"front\": plates[1]");
}

TEST(Capacitance, LeavesElectrodesOutAsOtherSensors) {
  Scene scene = sandwich();
  const SceneCapacitance all = capacitance(scene);
  scene.objects[1].role = Electrode{};
  const SceneCapacitance answer = capacitance(scene);
  ASSERT_EQ(answer.sensors[0].objects.size(), 1);
  EXPECT_EQ(answer.sensors[0].objects[0].capacitance, all.sensors[0].objects[0].capacitance);
}

TEST(Capacitance, KnowsOnlyGroundedConductors) {
  for (const ElectricalRole& role : {ElectricalRole{Floating{}}, ElectricalRole{Dielectric{50}}}) {
    Scene scene = sandwich();
    scene.objects[1].role = role;
    expect_refused(scene, {}, "\"behind\"");
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
