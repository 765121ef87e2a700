/// Tests that the reduced method refuses invalid input, and that the message says which element is refused
/// and why.

#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bem/scenes.hpp"
#include "fringe/error.hpp"
#include "reduced/reduced_capacitance.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using test::at;
using testing::HasSubstr;

std::string refusal(const std::function<void(Scene&)>& change, const ReducedOptions& options = {}) {
  return test::refusal(change, [&](const Scene& scene) { reduced_capacitance(scene, options); });
}

TEST(ReducedRefusals, TooManyTrianglesByName) {
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].shape = Sphere{0.01, 72};
              }),
              HasSubstr("object \"target\" has 5040 triangles"));
}

TEST(ReducedRefusals, Rooms) {
  EXPECT_THAT(refusal([](Scene& scene) { scene.has_room = true; }), HasSubstr("room"));
}

TEST(ReducedRefusals, ConductorsThatTouchOrCrossByName) {
  const auto named = HasSubstr("sensor \"front\" plates[0] and object \"target\" touch or cross");
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(0.02, 0, 0); }), named);
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(0.1, 0, 0); }), named);
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].pose = at(0, 0, 0.02);
                scene.objects[0].pose.rotate(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()));
              }),
              named);
}

TEST(ReducedRefusals, ScenesWithoutAnyConductorThatHasARow) {
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.sensors.clear();
                scene.objects[0].role = Floating{};
              }),
              HasSubstr("neither a sensor nor a grounded object"));
}

TEST(ReducedRefusals, PosesThatAreNotFinite) {
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(NAN, 0, 0); }),
              HasSubstr("object \"target\": its pose is not finite"));
}

TEST(ReducedRefusals, OptionsOutOfRange) {
  const auto same = [](Scene&) {};
  EXPECT_THAT(refusal(same, {.rtol = 1e-5}), HasSubstr("rtol 1e-05 must be from 0.0001 to 0.5"));
  EXPECT_THAT(refusal(same, {.rtol = NAN}), HasSubstr("rtol nan must be from"));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
