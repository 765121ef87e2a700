#include "formula/charged_surface.hpp"
#include "formula/facing_flux.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

double own_capacitance(const Shape& shape) {
  return make_charged_surface(triangulate(shape)).own_capacitance / (4 * std::numbers::pi);
}

// Own capacitances from the literature for conductors of size 1; the formula needs two digits.
TEST(ChargedSurface, KnowsTheOwnCapacitance) {
  EXPECT_NEAR(own_capacitance(Plate{1, 1}), 0.366788, 0.005);
  EXPECT_NEAR(own_capacitance(Cuboid{1, 1, 1}), 0.660678, 0.01);
  EXPECT_NEAR(own_capacitance(Sphere{1, 48}), 1, 0.015);
}

// The result must not depend on the position of the apex: potentials at the centres of cells shaped like the
// triangle itself would be far off.
TEST(ChargedSurface, OfANeedleHasTheOwnCapacitanceThatBoundaryElementsGiveIt) {
  for (const double height : {3e-3, 1e-4, 1e-7})
    for (const double foot : {0.0, 0.13, 0.5, 0.787}) {
      const Triangle needle{{{0, 0, 0}, {1, 0, 0}, {foot, height, 0}}};
      Scene scene;
      scene.objects = {test::object("needle", Mesh{"", 1, {needle}}, test::at(0, 0, 0))};
      const double expected = maxwell(scene, {.rtol = 1e-2}).values(0, 0) / vacuum_permittivity;
      EXPECT_NEAR(make_charged_surface({needle}).own_capacitance, expected, 0.03 * expected)
          << height << ' ' << foot;
    }
}

TEST(ChargedSurface, HasNoChargeOnWhatRoundingMakesOfALine) {
  const Triangle whole{{{0, 0.34, 0.3}, {-0.7, 0.09, -1}, {0, -0.9, 0.3}}};
  const Triangle line{{{0.0849508001749888, 0, -0.125},
                       {-0.9355730474531689, 0, -0.8053730954002256},
                       {-0.8762812525796406, 1.03786404433746e-17, -0.7658438456882323}}};
  EXPECT_TRUE(has_area(whole));
  EXPECT_FALSE(has_area(line));
  EXPECT_EQ(make_charged_surface({whole, line}).own_capacitance,
            make_charged_surface({whole}).own_capacitance);
}

TEST(ChargedSurface, OfAPlateHasItsChargeAtTheEdges) {
  const ChargedSurface plate = make_charged_surface(triangulate(Plate{1, 1}));
  EXPECT_NEAR(plate.charges.sum(), 1, 1e-12);
  EXPECT_GT(plate.charges.minCoeff(), 0);
  EXPECT_FALSE(plate.closed);
  double outer = 0;
  for (Eigen::Index i = 0; i < plate.nodes.cols(); ++i)
    if (plate.nodes.col(i).lpNorm<Eigen::Infinity>() > 0.25)
      outer += plate.charges[i];
  // This region has three quarters of the area.
  EXPECT_GT(outer, 0.85);
}

TEST(ChargedSurface, HasOrthonormalModesWithoutCharge) {
  const ChargedSurface box = make_charged_surface(triangulate(Cuboid{1, 0.5, 0.3}));
  EXPECT_TRUE(box.closed);
  EXPECT_EQ(box.linear_modes, 3);
  EXPECT_LT(box.modes.rowwise().sum().cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::MatrixXd products =
      box.modes * box.charges.cwiseInverse().asDiagonal() * box.modes.transpose();
  EXPECT_LT((products - Eigen::MatrixXd::Identity(products.rows(), products.cols())).norm(), 1e-9);
}

TEST(ChargedSurface, DoesNotMindSurfacesUponEachOther) {
  const std::vector<Triangle> once = triangulate(Plate{1, 1});
  std::vector<Triangle> twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  EXPECT_NEAR(make_charged_surface(twice).own_capacitance / make_charged_surface(once).own_capacitance, 1,
              0.02);
}

TEST(ChargedSurface, OfManyTrianglesHasClustersWithTheirArea) {
  const ChargedSurface sphere = make_charged_surface(triangulate(Sphere{1, 72}));
  std::size_t members = 0;
  for (const Cluster& cluster : sphere.clusters)
    members += cluster.members.size();
  EXPECT_EQ(members, sphere.triangles.size());
  EXPECT_LE(sphere.nodes.cols(), 128);
}

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
