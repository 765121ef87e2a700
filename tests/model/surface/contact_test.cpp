#include "surface/contact.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"
#include "surface/face.hpp"

/// Which bodies are in contact, and what becomes of them.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// Two bodies, the second one turned and moved.
ChargedBodies two_bodies(const Shape& first, const Shape& second, const Eigen::Isometry3d& pose,
                         const ElectricalRole& role = Grounded{}) {
  Scene scene;
  scene.objects = {test::object("first", first, test::at(0, 0, 0)),
                   test::object("second", second, pose, role)};
  return bodies_on_links(scene);
}

bool touch(const Shape& first, const Shape& second, const Eigen::Isometry3d& pose) {
  const ChargedBodies bodies = two_bodies(first, second, pose);
  const bool found = are_in_contact(bodies.bodies[0], bodies.bodies[1]);
  EXPECT_EQ(are_in_contact(bodies.bodies[1], bodies.bodies[0]), found);
  return found;
}

TEST(Contact, IsWhereBodiesTouchOverlapOrContainEachOther) {
  const Cuboid cube{0.1, 0.1, 0.1}, small{0.01, 0.01, 0.01};
  const Plate plate{0.05, 0.05};
  for (const Shape& second : std::vector<Shape>{cube, small, plate, Sphere{0.05, 8}}) {
    EXPECT_TRUE(touch(cube, second, test::at(0.04, 0, 0)));
    EXPECT_TRUE(touch(cube, second, test::at(0, 0, 0)));
    EXPECT_FALSE(touch(cube, second, test::at(0.2, 0, 0)));
  }
  EXPECT_TRUE(touch(cube, cube, test::at(0.1, 0.02, 0.03)));
  EXPECT_TRUE(touch(cube, cube, test::at(0.1 * (1 + 1e-15), 0, 0)));
  EXPECT_FALSE(touch(cube, cube, test::at(0.1001, 0, 0)));
  // Two plates that cross, and two of one plane beside each other.
  EXPECT_TRUE(touch(plate, plate, pose_from_axis({1, 0, 0}, 90, {0, 0, 0})));
  EXPECT_FALSE(touch(plate, plate, test::at(0.0501, 0, 0)));
  EXPECT_FALSE(touch(plate, plate, test::at(0, 0, 0.001)));
}

TEST(Contact, OfRoundBodiesAtDifferentPotentialsIsThatOfTheShapes) {
  // In this direction the polyhedra of 12 segments reach 3 % less far than the shapes.
  const Vector3d direction(std::cos(std::numbers::pi / 12), std::sin(std::numbers::pi / 12), 0);
  const Sphere ball{0.05, 12};
  const auto is_refused = [](const Shape& first, const Shape& second, const Eigen::Isometry3d& pose) {
    const ChargedBodies bodies = two_bodies(first, second, pose, Electrode{});
    const auto throws = [&](std::size_t a, std::size_t b) {
      try {
        refuse_contact(bodies.bodies[a], bodies.bodies[b], "they may differ");
        return false;
      } catch (const InputError&) {
        return true;
      }
    };
    EXPECT_EQ(throws(1, 0), throws(0, 1));
    return throws(0, 1);
  };
  const auto away = [&](double distance) {
    const Vector3d place = distance * direction;
    return test::at(place.x(), place.y(), place.z());
  };
  EXPECT_FALSE(are_in_contact(two_bodies(ball, ball, away(0.0995)).bodies[0],
                              two_bodies(ball, ball, away(0.0995)).bodies[1]));
  EXPECT_TRUE(is_refused(ball, ball, away(0.0995)));
  EXPECT_FALSE(is_refused(ball, ball, away(0.1005)));
  const Eigen::Isometry3d turned = pose_from_axis({0, 0, 1}, 15, {0, 0, 0});
  const Cuboid cube{0.02, 0.02, 0.02};
  EXPECT_TRUE(is_refused(ball, cube, away(0.0595) * turned));
  EXPECT_FALSE(is_refused(ball, cube, away(0.0601) * turned));
  const Cylinder rod{0.05, 0.1, 12};
  EXPECT_TRUE(is_refused(rod, rod, away(0.0995)));
  EXPECT_FALSE(is_refused(rod, rod, away(0.1005)));
}

TEST(Contact, AtOnePotentialJoinsBodiesToOneConductor) {
  const Cuboid cube{0.1, 0.1, 0.1};
  const ChargedBodies apart = two_bodies(cube, cube, test::at(0.2, 0, 0)),
                      touching = two_bodies(cube, cube, test::at(0.1, 0, 0));
  EXPECT_TRUE(contacts_at_one_potential(apart).empty());
  EXPECT_EQ(joined(apart).conductors.size(), 2U);
  ASSERT_EQ(contacts_at_one_potential(touching), (std::vector<Contact>{{0, 1}}));
  EXPECT_TRUE(have_one_potential(touching, 0, 1));
  const ChargedBodies one = joined(touching);
  ASSERT_EQ(one.conductors.size(), 1U);
  EXPECT_EQ(one.conductors[0].name, "first");
  EXPECT_EQ(one.conductors[0].members, (std::vector<std::string>{"first", "second"}));
  for (const ChargedBody& body : one.bodies)
    EXPECT_FALSE(triangles_of(body.surface).empty());
  const ChargedBodies other = two_bodies(cube, cube, test::at(0.1, 0, 0), Floating{});
  EXPECT_FALSE(have_one_potential(other, 0, 1));
  EXPECT_THROW(joined(other), InputError);
  EXPECT_THAT([&] { refuse_contact(other.bodies[0], other.bodies[1], "because"); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(HasSubstr("first"), HasSubstr("second"), HasSubstr("because"))));
  EXPECT_NO_THROW(refuse_contact(apart.bodies[0], apart.bodies[1], "because"));
}

TEST(Contact, TrianglesOfABoxFaceOutwardsAndCoverItsFaces) {
  const Vector3d half(0.3, 0.2, 0.1);
  const BoxSurface box = box_at_origin(half);
  double of_faces = 0, of_triangles = 0, volume = 0;
  for (const ChargedFace& face : box.faces) {
    of_faces += 4 * face.half_u * face.half_v;
    for (const Vector3d& corner : corners_of(face))
      EXPECT_LT((corner.cwiseAbs() - half).norm(), 1e-15);
  }
  for (const Triangle& triangle : oriented_triangles(box).triangles) {
    const Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    EXPECT_GT(normal.dot(triangle[0]), 0);
    of_triangles += normal.norm() / 2;
    volume += normal.dot(triangle[0]) / 6;
  }
  EXPECT_NEAR(of_triangles, of_faces, 1e-14);
  EXPECT_NEAR(volume, 8 * half.prod(), 1e-15);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
