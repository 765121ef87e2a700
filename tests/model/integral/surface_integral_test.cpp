/// ∫dA/d over whole surfaces: what encloses it, by which rules it is summed, and its derivatives.

#include "integral/surface_integral.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "integral/gauss.hpp"
#include "integral/splitting.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

const std::vector<Rectangle> plates{{{-0.5, -0.4, 0}, {1, 0, 0}, {0, 0.8, 0}},
                                    {{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

std::vector<Triangle> moved(const std::vector<Triangle>& triangles, const Isometry3d& pose) {
  std::vector<Triangle> result;
  for (const Triangle& triangle : triangles)
    result.push_back({pose * triangle[0], pose * triangle[1], pose * triangle[2]});
  return result;
}

const std::vector<Triangle> ball =
    moved(triangulate(Sphere{0.3, 10}), Isometry3d(Eigen::Translation3d(0.2, 0.1, 0.8)));

TEST(SurfaceIntegral, IsTheSumOverTrianglesAndPlatesAndLiesInItsEnclosure) {
  const Surface surface = make_surface(ball);
  double expected = 0;
  for (const Rectangle& plate : plates)
    expected += test::total_integral(ball, plate);
  const SurfaceIntegral found = surface_integral(surface, plates, {}, 0);
  EXPECT_NEAR(found.value, expected, 1e-13 * expected);
  EXPECT_EQ(found.bound, 0);
  const std::vector<PlateFrame> frames{plate_frame(plates[0]), plate_frame(plates[1])};
  const Enclosure bounds = enclosure(surface, surface.centroid, frames);
  EXPECT_LT(bounds.lower, expected);
  EXPECT_GT(bounds.upper, expected);
  EXPECT_LT(bounds.upper - bounds.lower, expected);
}

TEST(SurfaceIntegral, MeasuresTheSurface) {
  const Surface surface =
      make_surface(moved(triangulate(Cuboid{1, 2, 3}), Isometry3d(Eigen::Translation3d(4, 5, 6))));
  EXPECT_NEAR(surface.area, 22, 1e-13);
  EXPECT_LT((surface.centroid - Vector3d(4, 5, 6)).norm(), 1e-13);
  EXPECT_NEAR(surface.radius, std::sqrt(14) / 2, 1e-13);
  // Of a face of sides a and b at a distance c/2: ab·((a² + b²)/12 + c²/4).
  const auto of_face = [](double a, double b, double c) {
    return 2 * a * b * ((a * a + b * b) / 12 + c * c / 4);
  };
  EXPECT_NEAR(surface.squared_radius_moment, of_face(1, 2, 3) + of_face(2, 3, 1) + of_face(3, 1, 2), 1e-12);
}

TEST(SurfaceIntegral, StatesWhatATreeMayMiss) {
  Surface surface = make_surface(triangulate(Sphere{0.3, 64}));
  const std::vector<Rectangle> plate{{{-0.5, -0.4, -1}, {1, 0, 0}, {0, 0.8, 0}}};
  const double exact = surface_integral(surface, plate, {}, 0).value;
  surface.tree.emplace(surface.triangles);
  const SurfaceIntegral rough =
      surface_integral(surface, plate, {Exact{}, PlateRule::sum, FaceRule::all, 1e-3}, 0);
  EXPECT_LE(std::abs(rough.value - exact), rough.bound + 1e-13 * exact);
  EXPECT_LE(rough.bound, 1e-3 * rough.value);
  EXPECT_LT(rough.counts.triangles_evaluated, surface.triangles.size());
}

// By central differences, the ball turned and shifted.
TEST(SurfaceIntegral, HasTheDerivativesOfARigidMotion) {
  const Wrench wrench = surface_wrench(make_surface(ball), plates, {});
  constexpr double step = 1e-4;
  for (int coordinate = 0; coordinate < 6; ++coordinate) {
    const Vector3d axis = Vector3d::Unit(coordinate % 3);
    double difference = 0;
    for (const double sign : {1.0, -1.0}) {
      const Isometry3d motion = coordinate < 3 ? Isometry3d(Eigen::Translation3d(sign * step * axis))
                                               : Isometry3d(Eigen::AngleAxisd(sign * step, axis));
      difference +=
          sign * surface_integral(make_surface(moved(ball, motion)), plates, {}, 0).value / (2 * step);
    }
    EXPECT_NEAR(coordinate < 3 ? wrench.force[coordinate] : wrench.torque[coordinate - 3], difference, 1e-6);
  }
}

// Splitting is of second order: from one level to the next, a quarter of the error is left.
TEST(SurfaceIntegral, BySplittingAndByGaussConverges) {
  const PlateFrame plate = plate_frame(plates[0]);
  const Triangle triangle{Vector3d(-0.2, -0.3, 0.4), Vector3d(0.3, -0.2, 0.5), Vector3d(0, 0.3, 0.6)};
  const LocalTriangle local = to_local(plate, triangle);
  const double twice_area = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm();
  const double exact = plate_integral(triangle, plates[0]);
  double before = std::abs(split_integral(plate, local, twice_area, 1) - exact);
  for (int levels = 2; levels < 6; ++levels) {
    const double error = std::abs(split_integral(plate, local, twice_area, levels) - exact);
    EXPECT_NEAR(error / before, 0.25, 0.03) << levels;
    before = error;
  }
  EXPECT_NEAR(gauss_integral(plate, local, twice_area, gauss_rule(12)), exact, 1e-13);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
