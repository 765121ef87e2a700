#include "surface/panel.hpp"

#include <gtest/gtest.h>

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

/// A triangle with sides of 3, 4 and 5, its right angle at the origin.
const Triangle right{Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(0, 3, 0)};

TEST(Panel, HasTheAreaAndTheCentreOfItsTriangle) {
  const Panel panel = make_panel(right);
  EXPECT_NEAR(panel.area, 6, 1e-14);
  EXPECT_LT((panel.centre - Vector3d(4.0 / 3, 1, 0)).norm(), 1e-14);
  for (const Vector3d& corner : right)
    EXPECT_LE((corner - panel.centre).norm(), panel.radius * (1 + 1e-14));
}

TEST(Panel, PartsHaveItsAreaAndItsOrientation) {
  const auto normal = [](const Triangle& part) {
    return Vector3d((part[1] - part[0]).cross(part[2] - part[0]) / 2);
  };
  double of_quarters = 0, of_halves = 0;
  for (const Triangle& part : quarters(right)) {
    EXPECT_NEAR(normal(part).z(), 1.5, 1e-14);
    of_quarters += normal(part).z();
  }
  // The halves differ in area if the side is cut beside its middle.
  for (const Triangle& part : halves(right, longest_side(right), {3, 0.75, 0})) {
    EXPECT_GT(normal(part).z(), 0);
    of_halves += normal(part).z();
  }
  EXPECT_NEAR(of_quarters, 6, 1e-14);
  EXPECT_NEAR(of_halves, 6, 1e-14);
}

TEST(Panel, IsHalvedAcrossTheSideAlongWhichTheDensityChanges) {
  EXPECT_EQ(longest_side(right), 1U);
  // The charges differ by 8 and 7 along two sides, which is about as much: the longer side is chosen.
  Eigen::MatrixXd charges(4, 1);
  charges << 1, 9, 8, 3;
  EXPECT_EQ(side_to_halve(right, charges), 0U);
  // An even charge leaves the choice to the distances from the round surface.
  charges << 1, 1, 1, 1;
  EXPECT_EQ(side_to_halve(right, charges, {0, 0.1, 0.9}), 2U);
  const Triangle slim{Vector3d(0, 0, 0), Vector3d(100, 0, 0), Vector3d(0, 1, 0)};
  charges << 1, 1, 9, 3;
  EXPECT_EQ(side_to_halve(slim, charges), longest_side(slim));
}

TEST(Panel, DistancesAreThoseFromTheFaceAndFromItsOutline) {
  EXPECT_NEAR(segment_distance({2, 1, 0}, {0, 0, 0}, {4, 0, 0}), 1, 1e-15);
  EXPECT_NEAR(segment_distance({7, 4, 0}, {0, 0, 0}, {4, 0, 0}), 5, 1e-15);
  const Vector3d inside(1, 1, 0);  // on the circle that touches all sides
  EXPECT_NEAR(outline_distance(right, inside), 1, 1e-15);
  EXPECT_NEAR(triangle_distance(right, inside), 0, 1e-15);
  EXPECT_NEAR(triangle_distance(right, inside + Vector3d(0, 0, 2)), 2, 1e-15);
  EXPECT_NEAR(triangle_distance(right, {-3, -4, 0}), 5, 1e-14);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
