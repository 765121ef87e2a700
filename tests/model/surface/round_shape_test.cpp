#include "surface/round_shape.hpp"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/triangle.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::RoundShape;

constexpr double pi = std::numbers::pi;

/// Returns the sum of depth times area over the triangles of a shape.
double missing_volume(const Shape& shape) {
  const auto round = RoundShape::of(shape, Eigen::Isometry3d::Identity());
  double sum = 0;
  for (const Triangle& triangle : triangulate(shape))
    sum += round->depth(triangle) * twice_area(triangle) / 2;
  return sum;
}

TEST(RoundShape, TheDepthsOfFacetsAddUpToTheVolumeThatThePolyhedronLacks) {
  const std::vector<std::pair<Shape, double>> volumes{
      {Cylinder{0.02, 0.05, 24}, pi * 0.02 * 0.02 * 0.05},
      {Cone{0.02, 0.05, 24}, pi * 0.02 * 0.02 * 0.05 / 3},
      {Sphere{0.02, 24}, 4 * pi / 3 * 0.02 * 0.02 * 0.02},
      {Ellipsoid{0.03, 0.02, 0.01, 32}, 4 * pi / 3 * 0.03 * 0.02 * 0.01},
      {Capsule{0.02, 0.03, 24}, pi * 0.02 * 0.02 * (0.03 + 4.0 / 3 * 0.02)}};
  for (const auto& [shape, round] : volumes) {
    const double lacks = round - signed_volume(triangulate(shape));
    EXPECT_NEAR(missing_volume(shape), lacks, 0.05 * lacks) << "to first order";
  }
}

TEST(RoundShape, OnAnArcTheDepthsOfBothSidesAddUp) {
  // The inner facets take as much from the hole as the outer ones lack, in proportion to the radii squared.
  const Arc arc{0.01, 0.02, 0.005, 90, 8};
  const double angle = pi / 2 / 8, segment = (angle - std::sin(angle)) / 2;
  const double lacks = 8 * segment * (0.01 * 0.01 + 0.02 * 0.02) * 0.005;
  EXPECT_NEAR(missing_volume(arc), lacks, 0.05 * lacks);
}

TEST(RoundShape, FlatShapesHaveNone) {
  EXPECT_FALSE(RoundShape::of(Cuboid{1, 2, 3}, Eigen::Isometry3d::Identity()));
  EXPECT_FALSE(RoundShape::of(Plate{1, 2}, Eigen::Isometry3d::Identity()));
}

TEST(RoundShape, OnlySidesAlongARimFollowIt) {
  const auto round = RoundShape::of(Cylinder{1, 1, 8}, Eigen::Isometry3d::Identity());
  const auto corner = [](int k) { return Eigen::Vector3d(std::cos(pi / 4 * k), std::sin(pi / 4 * k), 0.5); };
  EXPECT_NEAR(round->middle(corner(0), corner(1)).head<2>().norm(), 1, 1e-15);
  // Simplified surfaces have chords across the face within the rim.
  EXPECT_EQ(round->middle(corner(0), corner(2)), Eigen::Vector3d((corner(0) + corner(2)) / 2));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
