#include "integral/pieces.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

/// Returns a triangle whose vertices, edges and plane lie on a plate's corners, edges and border planes up to
/// rounding.
LocalTriangle on_borders(const PlateFrame& plate, test::Random& random) {
  const auto rounded = [&] { return std::floor(random.uniform(-2, 3)) * 0x1p-53; };
  LocalTriangle triangle;
  for (Vector3d& vertex : triangle) {
    const double u = std::floor(random.uniform(-2, 4)) / 2, v = std::floor(random.uniform(-2, 4)) / 2;
    vertex = {u * plate.length_u + rounded(), v * plate.length_v + rounded(), random.uniform(0, 1)};
  }
  return triangle;
}

/// Computes how far a coordinate lies outside the strip.
double outside(Strip strip, double coordinate, double length) {
  switch (strip) {
  case Strip::below:
    return std::max(coordinate, 0.0);
  case Strip::within:
    return std::max({-coordinate, coordinate - length, 0.0});
  case Strip::above:
    return std::max(length - coordinate, 0.0);
  }
  return 0;
}

TEST(Pieces, AddUpToTheTriangleAndLieInTheirCellsWhateverRoundingSaysOfBorders) {
  PlateFrame plate;
  plate.length_u = 1.99995;
  plate.length_v = 0.577147;
  test::Random random(1);
  int in_several_cells = 0;
  for (int i = 0; i < test::draws(30000); ++i) {
    double shares = 0;
    int pieces = 0;
    for_each_piece(plate, on_borders(plate, random),
                   [&](Cell cell, const Vector3d& a, const Vector3d& b, const Vector3d& c, double share) {
                     shares += share;
                     ++pieces;
                     for (const Vector3d& corner : {a, b, c}) {
                       ASSERT_LT(outside(cell.u, corner.x(), plate.length_u), 1e-15);
                       ASSERT_LT(outside(cell.v, corner.y(), plate.length_v), 1e-15);
                     }
                   });
    ASSERT_NEAR(shares, 1, 1e-14);
    in_several_cells += pieces > 1;
  }
  EXPECT_GT(in_several_cells, test::draws(15000));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
