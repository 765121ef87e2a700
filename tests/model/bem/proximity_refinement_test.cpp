/// Tests which bodies cast a shadow on a face or a triangle that is too narrow for its elements to resolve.

#include "bem/proximity_refinement.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "bem/jacobi_basis.hpp"
#include "fringe/triangulation.hpp"

namespace fringe {
namespace {

using detail::ChargedBody;
using detail::ChargedFace;
using detail::EdgeKind;
using detail::most_functions;
using detail::Shadow;
using Eigen::Vector3d;

constexpr double large = 1;                              ///< half a side, metres
constexpr double seen = large / (most_functions / 2.0);  ///< narrowest shadow a face so large resolves
constexpr double close = seen / 100;

/// Returns a face in the plane z = height, turned about the z axis.
ChargedFace face(double half_u, double half_v, double height, double turn = 0) {
  const Eigen::AngleAxisd turned(turn, Vector3d::UnitZ());
  return {{0, 0, height}, turned * Vector3d::UnitX(), turned * Vector3d::UnitY(), half_u, half_v,
          EdgeKind::thin};
}

Shadow shadow_of(const ChargedFace& plate) {
  return Shadow(ChargedBody{0, {plate}, {}, "plate", {}});
}

/// Returns the shadow of the same plate as a body of two triangles.
Shadow shadow_of_triangles(const ChargedFace& plate) {
  const auto [a, b, c, d] = detail::corners_of(plate);
  return Shadow(ChargedBody{0, {}, {}, "mesh", {}, {{a, b, c}, {a, c, d}}});
}

TEST(Shadow, OfASmallPlateIsNarrowOnAFaceUntilTheGapIsWide) {
  const ChargedFace wall = face(large, large, 0);
  for (const auto shadow : {shadow_of, shadow_of_triangles}) {
    EXPECT_TRUE(shadow(face(0.5 * seen, 0.4 * seen, close)).is_narrow_on(wall));
    EXPECT_TRUE(shadow(face(0.5 * seen, 0.4 * seen, 0.4 * seen)).is_narrow_on(wall));
    EXPECT_FALSE(shadow(face(0.5 * seen, 0.4 * seen, 0.6 * seen)).is_narrow_on(wall));
    EXPECT_FALSE(shadow(face(1.2 * seen, 1.1 * seen, close)).is_narrow_on(wall));
  }
}

TEST(Shadow, OfAStripIsAsNarrowAsTheStripHoweverItIsTurned) {
  const ChargedFace wall = face(large, large, 0);
  for (const double turn : {0.0, 0.6, 1.57}) {
    EXPECT_TRUE(shadow_of(face(0.5 * large, 0.1 * seen, close, turn)).is_narrow_on(wall)) << turn;
    EXPECT_TRUE(shadow_of_triangles(face(0.5 * large, 0.1 * seen, close, turn)).is_narrow_on(wall)) << turn;
  }
}

TEST(Shadow, OfAStripIsNotNarrowOnAStripBesideIt) {
  // Along the strips the shadow is as long as they are, across them as wide.
  EXPECT_FALSE(shadow_of(face(large, 0.1 * seen, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
  EXPECT_FALSE(shadow_of_triangles(face(large, 0.1 * seen, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
  // Of two crossed strips, each casts a narrow shadow on the other.
  EXPECT_TRUE(shadow_of(face(0.1 * seen, large, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
}

TEST(Shadow, OfAnUprightPlateIsAsWideAsItIsHigh) {
  const auto upright = [](double half_height) {
    return ChargedFace{{0, 0, half_height + close},
                       Vector3d::UnitX(),
                       Vector3d::UnitZ(),
                       large,
                       half_height,
                       EdgeKind::thin};
  };
  EXPECT_TRUE(shadow_of(upright(0.5 * seen)).is_narrow_on(face(large, large, 0)));
  EXPECT_FALSE(shadow_of(upright(1.1 * seen)).is_narrow_on(face(large, large, 0)));
}

TEST(Shadow, OnATriangleIsNarrowWhenHalfTheTrianglesRadiusIsMore) {
  // The distance of the centre from the corners: two thirds of the height.
  constexpr double radius = 1;
  const Triangle triangle{Vector3d{radius, 0, 0}, Vector3d{-radius / 2, std::sqrt(3) / 2 * radius, 0},
                          Vector3d{-radius / 2, -std::sqrt(3) / 2 * radius, 0}};
  for (const auto shadow : {shadow_of, shadow_of_triangles}) {
    EXPECT_TRUE(shadow(face(0.3, 0.1, 0.3)).is_narrow_on(triangle));
    EXPECT_FALSE(shadow(face(0.3, 0.1, 0.45)).is_narrow_on(triangle));
    EXPECT_FALSE(shadow(face(0.3, 0.1, 5)).is_narrow_on(triangle));
    EXPECT_FALSE(shadow(face(0.6, 0.55, close)).is_narrow_on(triangle));
  }
}

}  // namespace
}  // namespace fringe
