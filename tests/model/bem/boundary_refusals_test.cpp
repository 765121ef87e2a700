/// Tests that boundary elements refuse invalid input, and that the message says which element is refused and
/// why.

#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/error.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using test::at;
using test::plate_above_sensor;
using test::sensor;
using testing::HasSubstr;

std::string refusal(const std::function<void(Scene&)>& change, const BoundaryElementOptions& options = {}) {
  return test::refusal(change, [&](const Scene& scene) { maxwell(scene, options); });
}

TEST(BoundaryElementRefusals, ADielectricSheet) {
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].shape = Plate{0.1, 0.1};
                scene.objects[0].role = Dielectric{3};
              }),
              HasSubstr("object \"target\" is dielectric, but its surface encloses no volume"));
}

TEST(BoundaryElementRefusals, AConductorWhoseObjectsDifferInPotential) {
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects.push_back(test::object("other", Cuboid{1, 1, 1}, at(0, 0, 2), Electrode{}));
                for (Object& object : scene.objects)
                  object.conductor = "arm";
              }),
              HasSubstr("object \"other\": conductor \"arm\" has one potential, but its objects differ"));
}

TEST(BoundaryElementRefusals, Rooms) {
  EXPECT_THAT(refusal([](Scene& scene) { scene.has_room = true; }), HasSubstr("room"));
}

TEST(BoundaryElementRefusals, ConductorsThatTouchOrCrossByName) {
  const auto named = HasSubstr("sensor \"front\" plates[0] and object \"target\" touch or cross");
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(0.02, 0, 0); }), named);
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(0.1, 0, 0); }), named);
  EXPECT_THAT(
      refusal([](Scene& scene) { scene.objects[0].pose = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()); }),
      named);
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].shape = Cuboid{0.3, 0.3, 0.1}; }), named);
}

TEST(BoundaryElementRefusals, SayHowFarASensorWouldHaveToBeMoved) {
  // The cube reaches from 3 cm below the plate to 7 cm above it.
  EXPECT_THAT(
      refusal([](Scene& scene) {
        scene.objects[0].shape = Cuboid{0.1, 0.1, 0.1};
      }),
      HasSubstr("sensor \"front\" plates[0] is clear of it when moved by more than 0.03 m along (0, 0, -1)"));
}

TEST(BoundaryElementRefusals, FloatingBodiesAndElectrodesThatTouchGroundedOnes) {
  for (const ElectricalRole& role : {ElectricalRole{Floating{}}, ElectricalRole{Electrode{}}})
    EXPECT_THAT(
        refusal([&](Scene& scene) {
          scene.objects.push_back(test::object("other", Cuboid{0.02, 0.02, 0.02}, at(0, 0, 0.03), role));
        }),
        HasSubstr(
            "object \"target\" and object \"other\" touch or cross: they may have different potentials"));
}

TEST(BoundaryElementRefusals, InvalidRectanglesSizesAndPoses) {
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.sensors[0].plates[0].edge_v = {0.05, 0.1, 0};
              }),
              HasSubstr("sensor \"front\" plates[0]: edge_u and edge_v are not at right angles"));
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].shape = Plate{0.1, 0};
              }),
              HasSubstr("object \"target\": a size of 0 is not positive"));
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.sensors[0].plates[0].edge_u = {1e-100, 0, 0};
              }),
              HasSubstr("sensor \"front\" plates[0]: a length of 1e-100 m is shorter than 1e-30 m"));
  for (const Shape& shape :
       {Shape(Sphere{1e-100, 16}), Shape(Cylinder{1e-100, 0.1, 16}), Shape(Disc{1e-100, 16})})
    EXPECT_THAT(refusal([&](Scene& scene) {
                  scene.objects[0].shape = shape;
                  scene.objects[0].pose = at(0, 0, 0);
                }),
                HasSubstr("object \"target\": a length of"));
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].pose = at(0, 0, std::numeric_limits<double>::quiet_NaN());
              }),
              HasSubstr("object \"target\": its pose is not finite"));
}

TEST(BoundaryElementRefusals, OptionsOutOfRange) {
  const auto nothing = [](Scene&) {};
  for (const double rtol : {0.0, -1e-3, 1e-7, 0.6, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(refusal(nothing, {.rtol = rtol}), HasSubstr("must be from 1e-06 to 0.5"));
  EXPECT_THAT(refusal(nothing, {.rtol = 1e-3, .most_unknowns = 90}), HasSubstr("needs at least 98 unknowns"));
}

TEST(BoundaryElementRefusals, AnEmptyScene) {
  EXPECT_THROW(maxwell(Scene{}), InputError);
}

TEST(BoundaryElements, SayWhenTheErrorWasNotReached) {
  const MaxwellMatrix answer = maxwell(plate_above_sensor(), {.rtol = 1e-5, .most_unknowns = 98});
  EXPECT_FALSE(answer.reached);
  EXPECT_GT(answer.errors(0, 0), 1e-5 * answer.values(0, 0));
}

TEST(BoundaryElementRefusals, ABodySoFarAwayThatRoundingChangesItsShape) {
  for (const double place : {1e15, 1e20, 1e30})
    EXPECT_THAT(refusal([&](Scene& scene) { scene.objects[0].pose = at(0, 0, place); }),
                HasSubstr("object \"target\": it is 0.141 m long and"))
        << place;
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
