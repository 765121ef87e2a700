#include "formula/facing_flux.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "fringe/pose.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

const Rectangle unit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

FacingFlux between(const Rectangle& a, const Rectangle& b, double softness = 0.1) {
  FacingFlux sum;
  for (const Triangle& triangle : plate_triangles(std::span(&a, 1))) {
    const auto& [p, q, r] = triangle;
    add_facing_flux(sum, triangle, (q - p).cross(r - p).normalized(), twice_area(triangle) / 2, false,
                    FacingPlate(b), softness);
  }
  return sum;
}

TEST(FacingFlux, OfParallelPlatesIsTheCommonAreaOverTheGap) {
  const Rectangle above{{0.3, 0.4, 0.2}, {1, 0, 0}, {0, 1, 0}};
  const FacingFlux sum = between(above, unit);
  EXPECT_NEAR(sum.area, 0.7 * 0.6, 1e-14);
  EXPECT_NEAR(sum.flux, 0.7 * 0.6 / 0.2, 1e-13);
  EXPECT_NEAR(sum.soft_flux, 0.7 * 0.6 / std::hypot(0.2, 0.1), 1e-13);
  EXPECT_NEAR(sum.tilted_excess, 0, 1e-14);
}

// The field lines between two half planes are arcs about their common line.
TEST(FacingFlux, OfAWedgeIsExact) {
  for (const double degrees : {1.0, 10.0, 45.0, 90.0, 130.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Rectangle lower{{0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Vector3d along(std::cos(angle), 0, std::sin(angle));
    const Rectangle upper{0.8 * along, 2 * along, {0, 1, 0}};
    // The distances from this line that both plates cover are 0.8 to 1.5.
    EXPECT_NEAR(between(upper, lower).flux, std::log(1.5 / 0.8) / angle, 1e-4 / angle) << degrees;
  }
}

TEST(FacingFlux, IsSymmetric) {
  for (int step = 0; step < 100; ++step) {
    const Rectangle other =
        transformed(Rectangle{{0, 0, 0}, {0.7, 0, 0}, {0, 1.3, 0}},
                    pose_from_axis({1, 0.1 * step, -0.4}, 23.0 * step,
                                   {std::sin(step), std::cos(2 * step), 1.6 + std::sin(3 * step)}));
    const FacingFlux forth = between(other, unit), back = between(unit, other);
    EXPECT_NEAR(forth.flux, back.flux, 2e-4 * back.flux + 1e-12) << step;
    EXPECT_NEAR(forth.area, back.area, 1e-9) << step;
  }
}

TEST(FacingFlux, SurfacesThatFaceAwayHaveNone) {
  const Triangle triangle{Vector3d(0, 0, 0.2), Vector3d(1, 0, 0.2), Vector3d(0, 1, 0.2)};
  FacingFlux sum;
  add_facing_flux(sum, triangle, {0, 0, 1}, 0.5, true, FacingPlate(unit), 0.1);
  EXPECT_EQ(sum.flux, 0);
  add_facing_flux(sum, triangle, {0, 0, -1}, 0.5, true, FacingPlate(unit), 0.1);
  EXPECT_NEAR(sum.flux, 0.5 / 0.2, 1e-13);
}

TEST(FacingFlux, SideBySideInOnePlaneThereIsNone) {
  const Rectangle beside{{1.1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(between(beside, unit).flux, 0);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
