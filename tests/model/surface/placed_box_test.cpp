#include "surface/placed_box.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "scenes.hpp"
#include "surface/target_contacts.hpp"

/// Boxes around bodies, how near others come to them, and where they touch.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

const Isometry3d turned = pose_from_axis({1, 2, 3}, 40, {0.3, 0.1, -0.2});

TEST(PlacedBox, FitsATurnedBoxAsClosely) {
  std::vector<Triangle> triangles = triangulate(Cuboid{0.3, 0.2, 0.1});
  for (Triangle& triangle : triangles)
    for (Vector3d& corner : triangle)
      corner = turned * corner;
  const PlacedBox box = placed_box(triangles);
  EXPECT_NEAR(box.box.volume(), 0.006, 1e-12);
  EXPECT_NEAR(box.distance(turned * Vector3d(0.45, 0, 0)), 0.3, 1e-12);
  EXPECT_EQ(box.distance(turned * Vector3d(0.1, 0, 0)), 0);
  // Moved as a whole, a box grows to hold its corners.
  EXPECT_GT(moved_box({Vector3d(-1, -1, -1), Vector3d(1, 1, 1)}, turned).volume(), 8);
}

TEST(PlacedBox, PartsAreTheLargerTheNearerTheyAre) {
  const Approach approach{{placed_box(triangulate(Cuboid{0.1, 0.1, 0.1}))},
                          {Isometry3d::Identity(), test::at(0.2, 0, 0)}};
  const auto part_at = [](double x) {
    return Eigen::AlignedBox3d(Vector3d(x - 0.01, -0.01, -0.01), Vector3d(x + 0.01, 0.01, 0.01));
  };
  EXPECT_GT(approach.relative_size(part_at(0.3)), approach.relative_size(part_at(0.6)));
  // The poses move the part: at -0.2 it comes to lie in the box.
  EXPECT_NEAR(approach.relative_size(part_at(-0.2)), approach.relative_size(part_at(0)), 1e-12);
}

TEST(PlacedBox, IsThatOfWhatIsSensedAndDriven) {
  const ChargedBodies bodies = charged_bodies(test::plate_above_sensor(), true);
  EXPECT_EQ(boxes_of_used(bodies, bodies.readings).size(), 1U);
  EXPECT_EQ(boxes_of_used(bodies, {}).size(), 0U);
  EXPECT_NEAR(bounds_of(bodies.bodies[1]).sizes().x(), 0.1, 1e-15);
}

/// A cube of 10 cm as the only body of a group.
RigidGroup cube(const std::string& name, const ElectricalRole& role) {
  Scene scene;
  scene.objects = {test::object(name, Cuboid{0.1, 0.1, 0.1}, test::at(0, 0, 0), role)};
  RigidGroup group{bodies_on_links(scene), {}, {}};
  group.boxes.push_back(bounds_of(group.bodies.bodies[0]));
  return group;
}

TEST(TargetContacts, AreToldByThePotentialsThatTheyJoin) {
  const Isometry3d touching = test::at(0.1, 0.02, 0), apart = test::at(0.101, 0, 0);
  const RigidGroup target = cube("hand", Grounded{}), pole = cube("pole", Electrode{});
  EXPECT_EQ(contacts_of(pole, target, touching).grounded, (std::vector<std::size_t>{0}));
  EXPECT_TRUE(contacts_of(pole, target, apart).grounded.empty());
  EXPECT_TRUE(contacts_of(cube("arm", Grounded{}), target, touching).is_joined);
  EXPECT_FALSE(contacts_of(cube("arm", Grounded{}), target, apart).is_joined);
}

TEST(TargetContacts, OfLinksAreRefusedWhereTheirPotentialsMayDiffer) {
  const RigidGroup arm = cube("arm", Grounded{}), pole = cube("pole", Electrode{});
  EXPECT_NO_THROW(refuse_contacts(arm, cube("hand", Grounded{}), test::at(0.1, 0, 0)));
  EXPECT_NO_THROW(refuse_contacts(arm, pole, test::at(0.101, 0, 0)));
  EXPECT_THROW(refuse_contacts(arm, pole, test::at(0.1, 0, 0)), InputError);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
