/// Whether closed surfaces enclose points, against shapes whose interior has a closed form.

#include "geometry/winding_number.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/shape.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "geometry/person.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

TEST(WindingNumber, TellsTheInsideOfABoxAndOfAnArc) {
  test::Random random(1);
  const std::vector<Triangle> box = triangulate(Cuboid{1, 2, 3}), arc = triangulate(Arc{0.5, 1, 1, 90, 16});
  for (int i = 0; i < 500; ++i) {
    const Vector3d point = random.in_box({-1, -1.5, -2}, {1, 1.5, 2});
    EXPECT_EQ(is_in_polyhedron(box, point),
              std::abs(point.x()) < 0.5 && std::abs(point.y()) < 1 && std::abs(point.z()) < 1.5);
    // The arc is not convex: its hollow is outside. Between a chord and its arc no one is asked.
    const double radius = point.head<2>().norm(), angle = std::atan2(point.y(), point.x());
    const double shrink = std::cos(EIGEN_PI / 64);
    const bool is_in_sector = std::abs(point.z()) < 0.5 && std::abs(angle) < EIGEN_PI / 4;
    if (is_in_sector && radius > 0.5 && radius < shrink) {
      EXPECT_TRUE(is_in_polyhedron(arc, point)) << point.transpose();
    }
    if (!is_in_sector || radius > 1 || radius < 0.5 * shrink) {
      EXPECT_FALSE(is_in_polyhedron(arc, point)) << point.transpose();
    }
  }
}

TEST(WindingNumber, IsKnownOnCornersAndEdgesOfAShellInsideAnother) {
  std::vector<Triangle> shells = triangulate(Cuboid{1, 2, 3});
  const std::vector<Triangle> inner = triangulate(Cuboid{0.25, 0.25, 0.25});
  shells.insert(shells.end(), inner.begin(), inner.end());
  for (const Vector3d& point : {Vector3d(0.125, 0.125, 0.125), Vector3d(0.125, 0.125, 0.0625)})
    EXPECT_TRUE(is_in_polyhedron(shells, point)) << point.transpose();
}

/// Returns six times the volume, and twice the sum of the areas as vectors, which vanishes if it is closed.
std::pair<double, Vector3d> volume_and_area(const std::vector<Triangle>& surface) {
  double volume = 0;
  Vector3d area = Vector3d::Zero();
  for (const Triangle& triangle : surface) {
    volume += triangle[0].dot(triangle[1].cross(triangle[2]));
    area += (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  }
  return {volume, area};
}

TEST(WindingNumber, PersonsAreClosedAndGrowWithTheirHeight) {
  for (const PersonAge age : {PersonAge::adult, PersonAge::child, PersonAge::infant})
    for (const Posture posture : {Posture::standing, Posture::lying, Posture::arm_stretched}) {
      const std::vector<Triangle> person = triangles_of_person(1.7, age, posture),
                                  half = triangles_of_person(0.85, age, posture);
      const auto [volume, area] = volume_and_area(person);
      EXPECT_GT(volume, 0);
      EXPECT_LT(area.norm(), 1e-12);
      EXPECT_NEAR(volume_and_area(half).first, volume / 8, 1e-9 * volume);
      Eigen::AlignedBox3d box;
      for (const Triangle& triangle : person)
        for (const Vector3d& corner : triangle)
          box.extend(corner);
      EXPECT_NEAR(box.center()[posture == Posture::lying ? 0 : 2], 0, 1e-9);
      EXPECT_NEAR(box.sizes().maxCoeff(), 1.7, 1e-9);
      // The trunk is above the middle of the body.
      const Vector3d chest = posture == Posture::lying ? Vector3d(-0.3, 0, 0) : Vector3d(0, 0, 0.3);
      const Vector3d beside = Vector3d(0, 1.7, 0);
      if (posture != Posture::arm_stretched) {
        EXPECT_TRUE(is_in_polyhedron(person, chest));
      }
      EXPECT_FALSE(is_in_polyhedron(person, beside));
    }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
