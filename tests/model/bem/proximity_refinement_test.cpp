/// Tests which bodies induce a charge on a face or a triangle that is too narrow for its elements to resolve.

#include "bem/proximity_refinement.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "bem/jacobi_basis.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::ChargedBody;
using detail::ChargedFace;
using detail::EdgeKind;
using detail::InducedCharge;
using detail::most_functions;
using Eigen::Vector3d;

constexpr double large = 1;  ///< half a side, metres
constexpr double seen =
    large / (most_functions / 2.0);  ///< width of the narrowest charge that a face so large resolves
constexpr double close = seen / 100;

/// Returns a face in the plane z = height, turned about the z axis.
ChargedFace face(double half_u, double half_v, double height, double turn = 0) {
  const Eigen::AngleAxisd turned(turn, Vector3d::UnitZ());
  return {{0, 0, height}, turned * Vector3d::UnitX(), turned * Vector3d::UnitY(), half_u, half_v,
          EdgeKind::thin};
}

InducedCharge charge_induced_by(const ChargedFace& plate) {
  return InducedCharge(ChargedBody{0, 0, detail::FlatPlate{plate}, "plate", {}});
}

/// Returns the charge induced by the same plate as a body of two triangles.
InducedCharge charge_induced_by_triangles(const ChargedFace& plate) {
  const auto [a, b, c, d] = detail::corners_of(plate);
  return InducedCharge(ChargedBody{0, 0, detail::TriangleSurface{{{a, b, c}, {a, c, d}}}, "mesh", {}});
}

TEST(InducedCharge, OfASmallPlateIsNarrowOnAFaceUntilTheGapIsWide) {
  const ChargedFace wall = face(large, large, 0);
  for (const auto induced_by : {charge_induced_by, charge_induced_by_triangles}) {
    EXPECT_TRUE(induced_by(face(0.5 * seen, 0.4 * seen, close)).is_narrow_on(wall));
    EXPECT_TRUE(induced_by(face(0.5 * seen, 0.4 * seen, 0.4 * seen)).is_narrow_on(wall));
    EXPECT_FALSE(induced_by(face(0.5 * seen, 0.4 * seen, 0.6 * seen)).is_narrow_on(wall));
    EXPECT_FALSE(induced_by(face(1.2 * seen, 1.1 * seen, close)).is_narrow_on(wall));
  }
}

TEST(InducedCharge, OfAStripIsAsNarrowAsTheStripHoweverItIsTurned) {
  const ChargedFace wall = face(large, large, 0);
  for (const double turn : {0.0, 0.6, 1.57}) {
    EXPECT_TRUE(charge_induced_by(face(0.5 * large, 0.1 * seen, close, turn)).is_narrow_on(wall)) << turn;
    EXPECT_TRUE(charge_induced_by_triangles(face(0.5 * large, 0.1 * seen, close, turn)).is_narrow_on(wall))
        << turn;
  }
}

TEST(InducedCharge, OfAStripIsNotNarrowOnAStripBesideIt) {
  // Along the strips the induced charge is as long as they are, across them as wide.
  EXPECT_FALSE(charge_induced_by(face(large, 0.1 * seen, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
  EXPECT_FALSE(
      charge_induced_by_triangles(face(large, 0.1 * seen, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
  // Of two crossed strips, each induces a narrow charge on the other.
  EXPECT_TRUE(charge_induced_by(face(0.1 * seen, large, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
}

TEST(InducedCharge, OfAnUprightPlateIsAsWideAsItIsHigh) {
  const auto upright = [](double half_height) {
    return ChargedFace{{0, 0, half_height + close},
                       Vector3d::UnitX(),
                       Vector3d::UnitZ(),
                       large,
                       half_height,
                       EdgeKind::thin};
  };
  EXPECT_TRUE(charge_induced_by(upright(0.5 * seen)).is_narrow_on(face(large, large, 0)));
  EXPECT_FALSE(charge_induced_by(upright(1.1 * seen)).is_narrow_on(face(large, large, 0)));
}

TEST(InducedCharge, OnATriangleIsNarrowWhenHalfTheTrianglesRadiusIsMore) {
  // The distance of the centre from the corners: two thirds of the height.
  constexpr double radius = 1;
  const Triangle triangle{Vector3d{radius, 0, 0}, Vector3d{-radius / 2, std::sqrt(3) / 2 * radius, 0},
                          Vector3d{-radius / 2, -std::sqrt(3) / 2 * radius, 0}};
  for (const auto induced_by : {charge_induced_by, charge_induced_by_triangles}) {
    EXPECT_TRUE(induced_by(face(0.3, 0.1, 0.3)).is_narrow_on(triangle));
    EXPECT_FALSE(induced_by(face(0.3, 0.1, 0.45)).is_narrow_on(triangle));
    EXPECT_FALSE(induced_by(face(0.3, 0.1, 5)).is_narrow_on(triangle));
    EXPECT_FALSE(induced_by(face(0.6, 0.55, close)).is_narrow_on(triangle));
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
