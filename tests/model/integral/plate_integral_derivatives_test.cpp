#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/pose.hpp"
#include "geometry.hpp"
#include "instruction_sets.hpp"
#include "integral/derivative/plate_wrench.hpp"

/// Tests the derivatives of the integral with respect to the triangle's pose.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::motion_along;
using test::Random;
using Derivatives = Eigen::Matrix<double, 6, 1>;

const Rectangle plate{{0, 0, 0}, {1, 0, 0}, {0, 0.8, 0}};

/// Differentiates the integral by central differences with two steps, which cancels errors of second order.
/// Rotations are about the point.
Derivatives differences(const Triangle& triangle, const Rectangle& over, double step, const Vector3d& point) {
  Derivatives result;
  for (int k = 0; k < 6; ++k) {
    const auto central = [&](double by) {
      return (plate_integral(transformed(triangle, motion_along(k, by, point)), over) -
              plate_integral(transformed(triangle, motion_along(k, -by, point)), over)) /
             (2 * by);
    };
    result[k] = (4 * central(step) - central(2 * step)) / 3;
  }
  return result;
}

/// Returns the derivatives with rotations about the point.
Derivatives derivatives_about(const Triangle& triangle, const Rectangle& over, const Vector3d& point) {
  const IntegralDerivatives found = plate_integral_derivatives(triangle, over);
  Derivatives result;
  result << found.translation, found.rotation - point.cross(found.translation);
  return result;
}

/// Returns the largest difference from central differences, relative to the largest derivative of its kind:
/// along axes, or about axes through the first vertex.
double largest_error(const Triangle& triangle) {
  const double size = std::max((triangle[1] - triangle[0]).norm(), (triangle[2] - triangle[0]).norm());
  const double step = 1e-3 * std::min(test::distance_between(triangle, plate), 0.3);
  const Derivatives found = derivatives_about(triangle, plate, triangle[0]);
  const Vector3d along = differences(triangle, plate, step, triangle[0]).head<3>();
  const Vector3d about = differences(triangle, plate, std::min(step / size, 1e-2), triangle[0]).tail<3>();
  return std::max((found.head<3>() - along).norm() / along.norm(),
                  (found.tail<3>() - about).norm() / (size * along.norm()));
}

TEST(PlateIntegralDerivatives, AgreeWithCentralDifferencesInTenThousandPoses) {
  Random random(26);
  double largest = 0;
  for (int i = 0; i < test::draws(10'000); ++i) {
    const double size = std::pow(10.0, random.uniform(-3, 0.3)),
                 height = std::pow(10.0, random.uniform(-2, 0.5));
    const Triangle shape = random.triangle_in_box({-size, -size, -size}, {size, size, size});
    Eigen::Isometry3d motion = random.rigid_motion();
    motion.translation() = random.in_box({-0.5, -0.5, height}, {1.5, 1.3, 2 * height});
    Triangle triangle = transformed(shape, motion);
    // The lowest vertex lies at the height drawn, so that no triangle crosses the plate.
    const double lowest = std::min({triangle[0].z(), triangle[1].z(), triangle[2].z()});
    for (Vector3d& vertex : triangle)
      vertex.z() += height - lowest;
    largest = std::max(largest, largest_error(triangle));
  }
  EXPECT_LT(largest, 1e-5);
}

TEST(PlateIntegralDerivatives, AgreeForThinTrianglesAndThoseAlongTheAxes) {
  Random random(27);
  double largest = 0;
  for (int i = 0; i < test::draws(2'000); ++i) {
    const Vector3d corner = random.in_box({-1, -1, 0.05}, {2, 1.8, 0.5});
    const auto axis = static_cast<Eigen::Index>(random.uniform(0, 3));
    const Vector3d along = random.uniform(0.1, 2) * Vector3d::Unit(axis);
    const Vector3d across = std::pow(10.0, random.uniform(-5, 0)) * Vector3d::Unit((axis + 1) % 3);
    largest = std::max(largest, largest_error({corner, corner + along, corner + along + across}));
  }
  EXPECT_LT(largest, 1e-5);
}

TEST(PlateIntegralDerivatives, ParallelToThePlateAreThoseOfAreaOverHeight) {
  // Within the plate's outline the integral is A/z.
  const Triangle triangle{Vector3d{0.2, 0.2, 0.1}, Vector3d{0.8, 0.2, 0.1}, Vector3d{0.2, 0.6, 0.1}};
  const IntegralDerivatives found = plate_integral_derivatives(triangle, plate);
  const double slope = -0.12 / 0.01;
  EXPECT_TRUE(found.translation.isApprox(Vector3d(0, 0, slope), 1e-14));
  const Vector3d centroid = (triangle[0] + triangle[1] + triangle[2]) / 3;
  EXPECT_TRUE(found.rotation.isApprox(centroid.cross(Vector3d(0, 0, slope)), 1e-14));
}

TEST(PlateIntegralDerivatives, TurnWithEverything) {
  Random random(28);
  for (int i = 0; i < 100; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, 0.1}, {2, 1.8, 1});
    const Eigen::Isometry3d motion = random.rigid_motion();
    const Derivatives before = derivatives_about(triangle, plate, triangle[0]);
    const Derivatives after =
        derivatives_about(transformed(triangle, motion), transformed(plate, motion), motion * triangle[0]);
    EXPECT_TRUE((motion.linear() * before.head<3>()).isApprox(after.head<3>(), 1e-9));
    EXPECT_TRUE((motion.linear() * before.tail<3>()).isApprox(after.tail<3>(), 1e-9));
  }
}

TEST(PlateIntegralDerivatives, KeepTheirAccuracyInAnyUnitOfLength) {
  const Triangle triangle{Vector3d{-0.3, 0.2, 0.1}, Vector3d{0.8, 1.2, 0.3}, Vector3d{0.2, 0.6, 0.7}};
  const Derivatives expected = derivatives_about(triangle, plate, Vector3d::Zero());
  for (const double unit : {0x1p-100, 0x1p100}) {
    const Triangle scaled{unit * triangle[0], unit * triangle[1], unit * triangle[2]};
    const Derivatives found = derivatives_about(
        scaled, {unit * plate.corner, unit * plate.edge_u, unit * plate.edge_v}, Vector3d::Zero());
    EXPECT_TRUE(found.head<3>().isApprox(expected.head<3>(), 1e-12));
    EXPECT_TRUE((found.tail<3>() / unit).isApprox(expected.tail<3>(), 1e-12));
  }
}

TEST(PlateIntegralDerivatives, AreZeroWithoutArea) {
  const Triangle point{Vector3d{0.2, 0.2, 0.1}, Vector3d{0.2, 0.2, 0.1}, Vector3d{0.2, 0.2, 0.1}};
  EXPECT_TRUE(plate_integral_derivatives(point, plate).translation.isZero(0));
}

TEST(PlateIntegralDerivatives, AreNotANumberInContact) {
  const Vector3d tip(0.5, 0.4, 0), b(0.2, 0.1, 0.3), c(0.9, 0.5, 0.3);
  // A single common point leaves the integral finite, but not its derivatives.
  for (const Triangle& triangle :
       {Triangle{tip, b, c}, Triangle{Vector3d(0.5, 0.4, -0.3), b, c},
        Triangle{tip, Vector3d(0.7, 0.4, 0), c},
        Triangle{Vector3d(1, 0.2, 0), Vector3d(1.3, 0.1, 0), Vector3d(1.3, 0.3, 0)}}) {
    const IntegralDerivatives found = plate_integral_derivatives(triangle, plate);
    EXPECT_TRUE(found.translation.array().isNaN().all());
    EXPECT_TRUE(found.rotation.array().isNaN().all());
  }
}

TEST(PlateIntegralDerivatives, OfASurfaceAreTheSumOverItsTriangles) {
  Random random(29);
  std::vector<Triangle> triangles;
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();
  for (int i = 0; i < 1'100; ++i) {
    triangles.push_back(random.triangle_in_box({-1, -1, 0.1}, {2, 1.8, 1}));
    const IntegralDerivatives one = plate_integral_derivatives(triangles.back(), plate);
    force += one.translation;
    torque += one.rotation;
  }
  const detail::Wrench all = detail::plate_wrench(TriangleBatch(triangles), plate);
  EXPECT_TRUE(all.force.isApprox(force, 1e-9));
  EXPECT_TRUE(all.torque.isApprox(torque, 1e-9));
}

TEST(PlateIntegralDerivatives, RefuseWhatTheIntegralRefuses) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(
      plate_integral_derivatives({Vector3d{infinite, 0, 0}, Vector3d{1, 0, 1}, Vector3d{0, 1, 1}}, plate),
      InputError);
  EXPECT_THROW(plate_integral_derivatives({Vector3d{0, 0, 1}, Vector3d{1, 0, 1}, Vector3d{0, 1, 1}},
                                          {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}),
               InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
