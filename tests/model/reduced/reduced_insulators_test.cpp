/// Tests the reduced method with dielectric bodies against boundary elements.

#include <gmock/gmock.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/error.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using test::at;
using test::box;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// The largest error goes with the fewest panels, on which the time for the preparation depends.
constexpr ReducedOptions quickly_prepared{.rtol = 1e-1};

/// Returns a sensor of 10 cm under a layer of 2 mm, and a grounded box on the link "hand", 3 cm before it.
Scene covered_sensor(double permittivity) {
  Scene scene =
      test::scene_of(test::square(0.1, 0), {box("cover", {-5, -5, 0}, {5, 5, 0.2}, Dielectric{permittivity}),
                                            test::on_link(0, box("hand", {-5, -5, 3}, {5, 5, 6}))});
  scene.links = {{"hand", {}, Isometry3d::Identity()}};
  return scene;
}

/// Tests that two answers agree within the errors that they state.
void expect_agreement(const MaxwellMatrix& one, const MaxwellMatrix& other) {
  EXPECT_TRUE(test::covers(one, other)) << one.values << "\n" << other.values << "\n" << one.errors;
  test::expect_agreement(one.readings, other.readings);
}

TEST(ReducedInsulators, ACoveredSensorAnswersAMovingHandAsBoundaryElementsDo) {
  Scene scene = covered_sensor(4);
  ReducedEvaluator reduced(scene, quickly_prepared);
  for (const double height : {0.0, 0.04}) {
    const Isometry3d pose = at(0.5 * height, 0, height);
    reduced.set_pose("hand", pose);
    scene.links[0].pose = pose;
    const MaxwellMatrix& found = reduced.maxwell();
    expect_agreement(found, maxwell(scene, {.rtol = 1e-2}));
    EXPECT_LT((found.errors.array() / found.values.array().abs()).maxCoeff(), 0.03);
  }
}

TEST(ReducedInsulatorsAtLength, AnInsulatingTargetIsABodyWithoutFreeCharge) {
  Scene scene = covered_sensor(4);
  scene.objects[1].role = Dielectric{10};
  scene.objects[1].target = true;
  scene.objects[0].role = Grounded{};
  scene.objects[0].pose = at(0, 0, -0.03);
  const MaxwellMatrix found = reduced_capacitance(scene, quickly_prepared);
  ASSERT_EQ(found.readings.size(), 1U);
  EXPECT_GT(*found.readings[0].change.value, 2 * *found.readings[0].change.error);
  expect_agreement(found, maxwell(scene, {.rtol = 1e-2}));
}

TEST(ReducedInsulators, WhatTouchesSeveralConductorsOrAnotherLinkIsRefusedByName) {
  Scene scene = covered_sensor(4);
  scene.objects[0] = box("pad", {-5, -5, 0}, {5, 5, 3}, Dielectric{4});
  const auto solve = [&] { reduced_capacitance(scene, quickly_prepared); };
  EXPECT_THAT(solve, ThrowsMessage<InputError>(HasSubstr("object \"pad\" and object \"hand\" touch")));
  scene.objects[1].link.reset();
  EXPECT_THAT(solve, ThrowsMessage<InputError>(testing::AllOf(
                         HasSubstr("object \"pad\" touches sensor \"front\" plates[0] and object \"hand\""),
                         HasSubstr("boundary-elements"))));
}

TEST(ReducedInsulators, ABodyOfTheMediumIsAsIfItWereNotThere) {
  Scene scene;
  scene.objects = {box("a", {-5, -5, -5}, {5, 5, 5})};
  scene.objects[0].role = Electrode{};
  const MaxwellMatrix alone = reduced_capacitance(scene, quickly_prepared);
  for (const double permittivity : {1.0, 2.0})
    for (const bool is_target : {false, true}) {
      Scene with = scene;
      with.medium.relative_permittivity = permittivity;
      // A difference that is little more than rounding is none.
      with.objects.push_back(
          box("ghost", {-5, -5, 25}, {5, 5, 35}, Dielectric{permittivity * (is_target ? 1 : 1 + 1e-12)}));
      with.objects.back().target = is_target;
      const MaxwellMatrix found = reduced_capacitance(with, quickly_prepared);
      EXPECT_NEAR(found.values(0, 0), permittivity * alone.values(0, 0),
                  permittivity * (found.errors(0, 0) + alone.errors(0, 0)));
      EXPECT_TRUE(found.reached);
    }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
