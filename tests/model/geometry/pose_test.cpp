#include "fringe/pose.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fringe/error.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

void expect_near(const Vector3d& value, const Vector3d& expected) {
  EXPECT_LT((value - expected).norm(), 1e-14) << value.transpose() << " instead of " << expected.transpose();
}

TEST(Pose, RotatesFirstAndTranslatesThen) {
  // 90° about z takes x to y.
  expect_near(pose_from_axis({0, 0, 1}, 90, {10, 20, 30}) * Vector3d(1, 0, 0), {10, 21, 30});
}

TEST(Pose, DoesNotDependOnTheLengthOfAxisOrQuaternion) {
  const Vector3d point(1, 2, 3), zero(0, 0, 0);
  const Vector3d expected = pose_from_axis({1, 1, 0}, 40, zero) * point;
  expect_near(pose_from_axis({1e-200, 1e-200, 0}, 40, zero) * point, expected);
  const double half = 20 * M_PI / 180, s = std::sin(half) / std::sqrt(2);
  expect_near(pose_from_quaternion({7 * std::cos(half), 7 * s, 7 * s, 0}, zero) * point, expected);
}

TEST(Pose, FromAMatrixIsRefusedUnlessItIsARotation) {
  const Vector3d zero(0, 0, 0);
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  EXPECT_NO_THROW(pose_from_matrix(identity, zero));
  EXPECT_THROW(pose_from_matrix(2 * identity, zero), InputError);
  EXPECT_THROW(pose_from_matrix(-identity, zero), InputError) << "a reflection";
  EXPECT_THROW(pose_from_matrix(identity, {0, 0, std::numeric_limits<double>::infinity()}), InputError);
  Eigen::Matrix3d with_nan = identity;
  with_nan(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(pose_from_matrix(with_nan, zero), InputError);
}

std::vector<Link> arm() {
  // The hand is described before its parent, the arm.
  return {{"hand", 1, pose_from_axis({0, 0, 1}, 90, {1, 0, 0})},
          {"arm", 2, pose_from_axis({0, 0, 1}, 90, {0, 0, 5})},
          {"room", std::nullopt, pose_from_axis({1, 0, 0}, 0, {100, 0, 0})}};
}

TEST(WorldPose, IsTheProductOfThePosesUpToTheRoot) {
  const std::vector<Eigen::Isometry3d> poses = world_poses(arm());
  // hand to arm: (1, 0, 0) ↦ (1, 1, 0); to room: ↦ (−1, 1, 5); to world: ↦ (99, 1, 5)
  expect_near(poses[0] * Vector3d(1, 0, 0), {99, 1, 5});
  expect_near(poses[2] * Vector3d(1, 0, 0), {101, 0, 0});
}

TEST(WorldPose, OfWhatHangsOnNoLinkIsTheIdentity) {
  const std::vector<Eigen::Isometry3d> poses = world_poses(arm());
  expect_near(attachment_pose(poses, std::nullopt) * Vector3d(1, 2, 3), {1, 2, 3});
  expect_near(attachment_pose(poses, 2) * Vector3d(1, 2, 3), {101, 2, 3});
}

TEST(SetPose, MovesTheLinkAndWhatHangsOnIt) {
  Scene scene;
  scene.links = arm();
  set_pose(scene, "room", pose_from_axis({1, 0, 0}, 0, {0, 0, 0}));
  const std::vector<Eigen::Isometry3d> poses = world_poses(scene.links);
  expect_near(poses[0] * Vector3d(1, 0, 0), {-1, 1, 5});
  expect_near(poses[2] * Vector3d(1, 0, 0), {1, 0, 0});
}

TEST(SetPose, RefusesAnUnknownLink) {
  Scene scene;
  scene.links = arm();
  EXPECT_THROW(set_pose(scene, "leg", Eigen::Isometry3d::Identity()), InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
