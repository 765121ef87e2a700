/// Tests the reduced method with conductors of several bodies, together and apart. Whether they answer as one
/// clean mesh is in tests/model/scene/conductors_by_method_test.cpp.

#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "reduced/arrangement.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Options for which few triangles suffice, so that bodies are prepared quickly.
const ReducedOptions loose{.rtol = 0.1};

TEST(ReducedConductors, MayBeOpenSurfaces) {
  std::vector<Triangle> triangles = angle_iron(0.06, 0.05, 0.02);
  triangles.pop_back();
  const Scene scene = above_sensor({object("angle", Mesh{"", 1, triangles}, at(0, 0, 0))});
  EXPECT_TRUE(covers(reduced_capacitance(scene, loose), maxwell(scene, {.rtol = 1e-2})));
}

/// Returns foot and leg on links of one robot that stands at a distance from the sensor.
Scene on_two_links() {
  Scene scene = above_sensor(foot_and_leg());
  scene.links = {{"robot", {}, at(0, 0, 0)}, {"upper", 0, at(0, 0, 0)}, {"lower", 0, at(0, 0, 0)}};
  scene.objects[0].link = 1;
  scene.objects[1].link = 2;
  return scene;
}

TEST(ReducedConductorsAtLength, ThatTouchAcrossLinksAreThoseOfASceneThere) {
  Scene scene = on_two_links();
  ReducedEvaluator evaluator(scene, loose);
  // Touching, shifted along the contact, apart, overlapping, and touching again.
  const std::vector<std::pair<double, double>> places{{0, 0}, {0.01, 0}, {0, 0.02}, {0.01, -0.01}, {0, 0}};
  for (const auto& [x, y] : places) {
    scene.links[2].pose = at(x, y, 0);
    evaluator.set_pose("lower", scene.links[2].pose);
    const MaxwellMatrix &answer = evaluator.maxwell(), there = reduced_capacitance(scene, loose);
    EXPECT_EQ(answer.values.rows(), y > 0 ? 3 : 2);
    EXPECT_EQ(answer.conductors, there.conductors);
    EXPECT_EQ(answer.members, there.members);
    EXPECT_EQ(answer.values, there.values);
    EXPECT_EQ(answer.charges, there.charges);
    EXPECT_TRUE(covers(answer, maxwell(scene, {.rtol = 2e-2}))) << x << " " << y;
  }
  const Eigen::MatrixXd before = evaluator.maxwell().values;
  evaluator.set_pose("lower", at(0, -0.03, -0.02));
  EXPECT_THAT([&] { evaluator.maxwell(); },
              ThrowsMessage<InputError>(
                  testing::AllOf(HasSubstr("sensor \"front\" plates[0] and object \"leg\" touch or cross"),
                                 HasSubstr("they may have different potentials"),
                                 HasSubstr("is clear of it when moved by more than"))));
  evaluator.set_pose("lower", at(0, 0, 0));
  EXPECT_EQ(evaluator.maxwell().values, before);
}

TEST(ReducedConductors, AreJoinedAnewOnlyWhenTheirBodiesMoveToEachOther) {
  const Scene scene = on_two_links();
  detail::Arrangement arrangement(scene, ReducedContacts::all, 0.1,
                                  std::make_shared<detail::LinkPoses>(scene.links));
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 1U);
  EXPECT_EQ(arrangement.rigid().size(), 2U);
  // The same poses, up to rounding, in another place.
  const Eigen::Isometry3d turn = pose_from_axis({1, 2, 3}, 40, {0.1, 0.2, 0.3});
  arrangement.set_pose("robot", pose_from_axis({3, 2, 1}, 70, {0, 0, 1}));
  arrangement.set_pose("upper", turn);
  arrangement.set_pose("lower", turn);
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 1U);
  arrangement.set_pose("lower", turn * at(0, 1, 0));
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 2U);
  EXPECT_EQ(arrangement.rigid().size(), 3U);
  arrangement.set_pose("upper", at(0, 0, 0));
  arrangement.set_pose("lower", at(0.01, 0, 0));
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 3U);
  EXPECT_EQ(arrangement.rigid().size(), 2U);
}

TEST(ReducedConductors, AreRefusedInContactAsTheOptionsSay) {
  const auto expect_refusal = [](const Scene& scene, ReducedContacts contacts) {
    EXPECT_THAT([&] { reduced_capacitance(scene, {.rtol = 0.1, .contacts = contacts}); },
                ThrowsMessage<InputError>(HasSubstr("object \"foot\" and object \"leg\" touch")));
  };
  expect_refusal(on_two_links(), ReducedContacts::of_one_link);
  expect_refusal(above_sensor(foot_and_leg()), ReducedContacts::refused);
  EXPECT_EQ(reduced_capacitance(above_sensor(foot_and_leg()),
                                {.rtol = 0.1, .contacts = ReducedContacts::of_one_link})
                .values.rows(),
            2);
}

TEST(ReducedConductors, OfTooManyTrianglesTogetherAreRefusedByName) {
  EXPECT_THAT(
      [] {
        reduced_capacitance(above_sensor({object("ball", Sphere{0.02, 38}, at(0, 0, 0.05)),
                                          object("other", Sphere{0.02, 38}, at(0.01, 0, 0.05))}));
      },
      ThrowsMessage<InputError>(HasSubstr("object \"ball\" with what touches it has 2736 triangles")));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
