#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/joint.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene.hpp"
#include "geometry.hpp"
#include "geometry/link_motion.hpp"
#include "geometry/wrench.hpp"

/// Poses, joints and links, and wrenches: how they change with the frame, and what pairs of bodies contribute
/// to each link.
namespace fringe::detail::FRINGE_TEST_FILE {
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
  EXPECT_THROW(set_pose(scene, "leg", Eigen::Isometry3d::Identity()), InputError);
}

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

TEST(Joint, IsRefusedWithTheChoices) {
  const auto expect_refused = [](std::string_view joint, double position, const std::string& reason) {
    EXPECT_THAT([&] { joint_poses(links(), joint, position); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr(reason)));
  };
  expect_refused("hip", 0, "there is no joint \"hip\"; there are: lift");
  expect_refused("tip", 0, "joint \"tip\" follows \"turn\"");
  expect_refused("lift", std::numeric_limits<double>::infinity(), "must be finite");
}

TEST(Joint, CannotFollowItselfOrNothing) {
  std::vector<Link> circle{link_with({.name = "a", .mimic = Joint::Mimic{"b"}}),
                           link_with({.name = "b", .mimic = Joint::Mimic{"a"}})};
  EXPECT_THROW(place_joints(circle), InputError);
  std::vector<Link> alone{link_with({.name = "a", .mimic = Joint::Mimic{"b"}})};
  EXPECT_THROW(place_joints(alone), InputError);
}

Eigen::Isometry3d shifted(double x) {
  return pose_from_axis({0, 0, 1}, 0, {x, 0, 0});
}

/// Returns an arm with a at_hand, and a table beside it.
std::vector<Link> arm_and_table() {
  return {{"hand", 1, shifted(1)}, {"arm", std::nullopt, shifted(10)}, {"table", std::nullopt, shifted(100)}};
}

constexpr std::size_t at_hand = 0, at_arm = 1, at_table = 2;

double x_of(const LinkMotion& motion, std::size_t link) {
  return motion.world_pose(link).translation().x();
}

TEST(LinkMotion, MovesALinkWithItsDescendants) {
  LinkMotion motion(std::make_shared<LinkPoses>(arm_and_table()));
  motion.set_pose("arm", shifted(20));
  motion.update();
  EXPECT_EQ(x_of(motion, at_hand), 21);
  EXPECT_EQ(x_of(motion, at_table), 100);
  EXPECT_TRUE(motion.rigid(at_hand, at_arm));
  EXPECT_FALSE(motion.rigid(at_hand, at_table));
  EXPECT_FALSE(motion.rigid(at_hand, std::nullopt));
  EXPECT_TRUE(motion.rigid(at_table, std::nullopt));
}

TEST(LinkMotion, ForgetsMovesWhenSettled) {
  LinkMotion motion(std::make_shared<LinkPoses>(arm_and_table()));
  motion.set_pose("hand", shifted(2));
  motion.update();
  motion.settle();
  motion.update();
  EXPECT_TRUE(motion.rigid(at_hand, at_arm));
  EXPECT_EQ(x_of(motion, at_hand), 12);
}

TEST(LinkMotion, KeepsAMoveThatItHasNotSettledBesideALaterOne) {
  LinkMotion motion(std::make_shared<LinkPoses>(arm_and_table()));
  motion.set_pose("hand", shifted(2));
  motion.update();
  motion.set_pose("table", shifted(200));
  motion.update();
  EXPECT_FALSE(motion.rigid(at_hand, at_arm));
  EXPECT_FALSE(motion.rigid(at_hand, at_table));
}

TEST(LinkMotion, OfTwoThatShareTheirPosesEachHasItsOwnLastAnswer) {
  const auto poses = std::make_shared<LinkPoses>(arm_and_table());
  LinkMotion often(poses), seldom(poses);
  for (const double x : {2.0, 3.0}) {
    poses->set_pose("hand", shifted(x));
    often.update();
    EXPECT_FALSE(often.rigid(at_hand, at_arm));
    often.settle();
  }
  often.update();
  seldom.update();
  EXPECT_TRUE(often.rigid(at_hand, at_arm));
  EXPECT_FALSE(seldom.rigid(at_hand, at_arm));
  EXPECT_EQ(x_of(seldom, at_hand), 13);
}

TEST(LinkMotion, BeginsWithThePosesAsTheyAre) {
  const auto poses = std::make_shared<LinkPoses>(arm_and_table());
  poses->set_pose("arm", shifted(20));
  LinkMotion late(poses);
  EXPECT_EQ(x_of(late, at_hand), 21);
  late.update();
  EXPECT_TRUE(late.rigid(at_hand, at_table));
}

TEST(LinkPoses, RefuseAnUnknownLinkAndCountNoChange) {
  LinkPoses poses(arm_and_table());
  EXPECT_THROW(poses.set_pose("foot", shifted(0)), InputError);
  EXPECT_EQ(poses.changes(), 0);
}

using Eigen::Isometry3d;

TEST(Wrench, OfAForceAtAPointIsThatOfTheMovedForceAtTheMovedPoint) {
  test::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Isometry3d pose = random.rigid_motion();
    const Vector3d force = random.in_box({-1, -1, -1}, {1, 1, 1}),
                   at = random.in_box({-1, -1, -1}, {1, 1, 1});
    const Wrench outer = in_outer_frame({force, at.cross(force)}, pose);
    const Vector3d moved = pose.linear() * force;
    EXPECT_LT((outer.force - moved).norm(), 1e-14);
    EXPECT_LT((outer.torque - (pose * at).cross(moved)).norm(), 1e-14);
  }
}

/// A point on a link, or in the world.
struct Charge {
  std::optional<std::size_t> link;
  Vector3d at;
};

/// Springs between all points: half the sum of the squared distances.
double energy(const std::vector<Charge>& charges, const LinkPoses& poses) {
  double sum = 0;
  for (std::size_t a = 0; a < charges.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      sum += (poses.world_pose(charges[a].link) * charges[a].at -
              poses.world_pose(charges[b].link) * charges[b].at)
                 .squaredNorm() /
             2;
  return sum;
}

// An arm with a hand, a table beside it, and something in the world.
TEST(Wrench, OfPairsAddUpToTheDerivativesByEachLink) {
  test::Random random(2);
  const std::vector<Link> links{{"arm", std::nullopt, random.rigid_motion()},
                                {"hand", 0, random.rigid_motion()},
                                {"table", std::nullopt, random.rigid_motion()}};
  const std::vector<Charge> charges{
      {0, {0.1, 0.2, 0.3}}, {1, {0.3, -0.2, 0.1}}, {2, {0, 1, 0.5}}, {std::nullopt, {1, 0, 0}}};
  LinkPoses poses(links);
  poses.update();
  std::vector<PairWrench> pairs;
  for (std::size_t a = 0; a < charges.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Vector3d at = poses.world_pose(charges[a].link) * charges[a].at,
                     pull = at - poses.world_pose(charges[b].link) * charges[b].at;
      pairs.push_back({charges[a].link, charges[b].link, {pull, at.cross(pull)}});
    }
  const std::vector<LinkDerivatives> found = derivatives_by_link(poses, pairs);
  ASSERT_EQ(found.size(), links.size());
  constexpr double step = 1e-5;
  for (std::size_t link = 0; link < links.size(); ++link) {
    EXPECT_EQ(found[link].link, links[link].name);
    const Isometry3d world = poses.world_pose(link), parent = world * links[link].pose.inverse();
    for (int coordinate = 0; coordinate < 6; ++coordinate) {
      const auto energy_after = [&](double amount) {
        LinkPoses there(links);
        there.set_pose(links[link].name, parent.inverse() *
                                             test::motion_along(coordinate, amount, world.translation()) *
                                             world);
        there.update();
        return energy(charges, there);
      };
      const double difference = (energy_after(step) - energy_after(-step)) / (2 * step);
      EXPECT_NEAR(found[link].change[coordinate], difference, 1e-7) << links[link].name << ' ' << coordinate;
    }
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
