#include "fringe/capacitance.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"

namespace fringe {
namespace {

Object plate_at(const std::string& name, double size, double height) {
  return {name,       std::nullopt, Plate{size, size}, pose_from_axis({0, 0, 1}, 0, {0, 0, height}),
          Grounded{}, true};
}

/// A 10 cm sensor with plates of the same size 2 cm in front of it and 4 cm behind it.
Scene sandwich() {
  Scene scene;
  Sensor sensor;
  sensor.name = "front";
  sensor.plates = {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}};
  scene.sensors.push_back(sensor);
  scene.objects = {plate_at("near", 0.1, 0.02), plate_at("behind", 0.1, -0.04)};
  return scene;
}

TEST(Capacitance, OfParallelPlatesIsPermittivityTimesAreaOverDistance) {
  Scene scene = sandwich();
  scene.medium.relative_permittivity = 2;
  const SensorCapacitance felt = capacitance(scene).at(0);
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
  const double one = capacitance(scene).at(0).total;
  scene.sensors[0].plates.push_back(scene.sensors[0].plates[0]);
  EXPECT_DOUBLE_EQ(capacitance(scene).at(0).total, 2 * one);
}

TEST(Capacitance, FollowsTheMethod) {
  Scene scene = sandwich();
  scene.objects.resize(1);
  scene.objects[0] = plate_at("large", 0.3, 0.02);
  const double exact = capacitance(scene).at(0).total;
  const double split = capacitance(scene, {Split{3}}).at(0).total;
  EXPECT_NE(split, exact);
  EXPECT_NEAR(split, exact, 0.05 * exact);
}

TEST(Capacitance, MovesWithTheLinks) {
  Scene scene = sandwich();
  scene.links.push_back({"arm", std::nullopt, pose_from_axis({1, 1, 0}, 70, {1, 2, 3})});
  scene.sensors[0].link = 0;
  for (Object& object : scene.objects)
    object.link = 0;
  const double expected = capacitance(sandwich()).at(0).total;
  EXPECT_NEAR(capacitance(scene).at(0).total, expected, 1e-13 * expected);
}

TEST(Capacitance, WithoutObjectsIsZeroAndLeavesTheInputVoltage) {
  Scene scene = sandwich();
  scene.objects.clear();
  const SensorCapacitance felt = capacitance(scene).at(0);
  EXPECT_EQ(felt.total, 0);
  EXPECT_EQ(felt.voltage, 2.5);
  EXPECT_EQ(felt.delta_voltage, 0);
}

TEST(Capacitance, OnContactIsInfiniteAndLeavesNoVoltage) {
  Scene scene = sandwich();
  scene.objects.push_back(plate_at("touching", 0.02, 0));
  const SensorCapacitance felt = capacitance(scene).at(0);
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

TEST(Capacitance, KnowsOnlyGroundedConductors) {
  for (const ElectricalRole& role : {ElectricalRole{Floating{}}, ElectricalRole{Dielectric{50}}}) {
    Scene scene = sandwich();
    scene.objects[1].role = role;
    try {
      capacitance(scene);
      FAIL() << "accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("\"behind\""));
    }
  }
}

}  // namespace
}  // namespace fringe
