#include "geometry/link_motion.hpp"

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

Eigen::Isometry3d shifted(double x) {
  return pose_from_axis({0, 0, 1}, 0, {x, 0, 0});
}

/// Returns an arm with a hand, and a table beside it.
std::vector<Link> arm_and_table() {
  return {{"hand", 1, shifted(1)}, {"arm", std::nullopt, shifted(10)}, {"table", std::nullopt, shifted(100)}};
}

constexpr std::size_t hand = 0, arm = 1, table = 2;

double x_of(const LinkMotion& motion, std::size_t link) {
  return motion.world_pose(link).translation().x();
}

TEST(LinkMotion, MovesALinkWithItsDescendants) {
  LinkMotion motion(std::make_shared<LinkPoses>(arm_and_table()));
  motion.set_pose("arm", shifted(20));
  motion.update();
  EXPECT_EQ(x_of(motion, hand), 21);
  EXPECT_EQ(x_of(motion, table), 100);
  EXPECT_TRUE(motion.rigid(hand, arm));
  EXPECT_FALSE(motion.rigid(hand, table));
  EXPECT_FALSE(motion.rigid(hand, std::nullopt));
  EXPECT_TRUE(motion.rigid(table, std::nullopt));
}

TEST(LinkMotion, ForgetsMovesWhenSettled) {
  LinkMotion motion(std::make_shared<LinkPoses>(arm_and_table()));
  motion.set_pose("hand", shifted(2));
  motion.update();
  motion.settle();
  motion.update();
  EXPECT_TRUE(motion.rigid(hand, arm));
  EXPECT_EQ(x_of(motion, hand), 12);
}

TEST(LinkMotion, KeepsAMoveThatItHasNotSettledBesideALaterOne) {
  LinkMotion motion(std::make_shared<LinkPoses>(arm_and_table()));
  motion.set_pose("hand", shifted(2));
  motion.update();
  motion.set_pose("table", shifted(200));
  motion.update();
  EXPECT_FALSE(motion.rigid(hand, arm));
  EXPECT_FALSE(motion.rigid(hand, table));
}

TEST(LinkMotion, OfTwoThatShareTheirPosesEachHasItsOwnLastAnswer) {
  const auto poses = std::make_shared<LinkPoses>(arm_and_table());
  LinkMotion often(poses), seldom(poses);
  for (const double x : {2.0, 3.0}) {
    poses->set_pose("hand", shifted(x));
    often.update();
    EXPECT_FALSE(often.rigid(hand, arm));
    often.settle();
  }
  often.update();
  seldom.update();
  EXPECT_TRUE(often.rigid(hand, arm));
  EXPECT_FALSE(seldom.rigid(hand, arm));
  EXPECT_EQ(x_of(seldom, hand), 13);
}

TEST(LinkMotion, BeginsWithThePosesAsTheyAre) {
  const auto poses = std::make_shared<LinkPoses>(arm_and_table());
  poses->set_pose("arm", shifted(20));
  LinkMotion late(poses);
  EXPECT_EQ(x_of(late, hand), 21);
  late.update();
  EXPECT_TRUE(late.rigid(hand, table));
}

TEST(LinkPoses, RefuseAnUnknownLinkAndCountNoChange) {
  LinkPoses poses(arm_and_table());
  EXPECT_THROW(poses.set_pose("foot", shifted(0)), InputError);
  EXPECT_EQ(poses.changes(), 0);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
