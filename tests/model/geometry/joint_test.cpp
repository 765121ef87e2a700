#include "fringe/joint.hpp"

#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/scene.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// A link with a joint at (0, 0, 1), turned by a quarter about x.
Link link_with(Joint joint) {
  joint.rest = Eigen::Translation3d(0, 0, 1) * Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX());
  Link link{joint.name, std::nullopt};
  link.joint = joint;
  return link;
}

/// "lift" shifts along its own z, "turn" follows it twice as far, "tip" follows "turn".
std::vector<Link> links() {
  std::vector<Link> links{link_with({.name = "turn", .mimic = Joint::Mimic{"lift", 2, 0.5}}),
                          link_with({.name = "lift", .kind = Joint::Kind::prismatic, .axis = {0, 0, 3}}),
                          link_with({.name = "tip", .mimic = Joint::Mimic{"turn", -1, 0}}),
                          {"fixed", std::nullopt}};
  place_joints(links);
  return links;
}

TEST(Joint, ShiftsAndTurnsInTheFrameOfItsLink) {
  const std::vector<Link> at_rest = links();
  const Joint& lift = *at_rest[1].joint;
  EXPECT_TRUE(pose_at(lift, 0).isApprox(lift.rest, 0));
  EXPECT_TRUE((pose_at(lift, 0.3) * Vector3d::Zero()).isApprox(Vector3d(0, -0.3, 1), 1e-15));
  const Joint& turn = *at_rest[0].joint;
  // A quarter about its own z moves x to y, which is the world's z.
  EXPECT_TRUE((pose_at(turn, std::numbers::pi / 2) * Vector3d::UnitX()).isApprox(Vector3d(0, 0, 2), 1e-15));
}

TEST(Joint, FollowsThroughOthers) {
  const std::vector<Link> at_rest = links();
  EXPECT_EQ(at_rest[0].joint->position, 0.5);
  EXPECT_EQ(at_rest[2].joint->position, -0.5);
  const std::vector<LinkPose> moved = joint_poses(at_rest, "lift", 0.1);
  ASSERT_EQ(moved.size(), 3U);
  EXPECT_EQ(moved[0].link, 0U);
  EXPECT_TRUE(moved[0].pose.isApprox(pose_at(*at_rest[0].joint, 0.7), 1e-15));
  EXPECT_TRUE(moved[2].pose.isApprox(pose_at(*at_rest[2].joint, -0.7), 1e-15));
}

std::string error_of(std::string_view joint, double position) {
  try {
    joint_poses(links(), joint, position);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Joint, IsRefusedWithTheChoices) {
  EXPECT_THAT(error_of("hip", 0), HasSubstr("there is no joint \"hip\"; there are: lift"));
  EXPECT_THAT(error_of("tip", 0), HasSubstr("joint \"tip\" follows \"turn\""));
  EXPECT_THAT(error_of("lift", std::numeric_limits<double>::infinity()), HasSubstr("must be finite"));
}

TEST(Joint, CannotFollowItselfOrNothing) {
  std::vector<Link> circle{link_with({.name = "a", .mimic = Joint::Mimic{"b"}}),
                           link_with({.name = "b", .mimic = Joint::Mimic{"a"}})};
  EXPECT_THROW(place_joints(circle), InputError);
  std::vector<Link> alone{link_with({.name = "a", .mimic = Joint::Mimic{"b"}})};
  EXPECT_THROW(place_joints(alone), InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
