/// Wrenches: how they change with the frame, and what pairs of bodies contribute to each link.

#include "geometry/wrench.hpp"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/pose.hpp"
#include "geometry.hpp"
#include "geometry/link_motion.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

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
      const Vector3d axis = Vector3d::Unit(coordinate % 3);
      double difference = 0;
      for (const double sign : {1.0, -1.0}) {
        Isometry3d moved = world;
        if (coordinate < 3)
          moved.pretranslate(sign * step * axis);
        else
          moved.linear() = Eigen::AngleAxisd(sign * step, axis) * world.linear();
        LinkPoses there(links);
        there.set_pose(links[link].name, parent.inverse() * moved);
        there.update();
        difference += sign * energy(charges, there) / (2 * step);
      }
      EXPECT_NEAR(found[link].change[coordinate], difference, 1e-7) << links[link].name << ' ' << coordinate;
    }
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
