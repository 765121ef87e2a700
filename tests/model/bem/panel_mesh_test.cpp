/// Tests the panels of surfaces, how they are divided, and the numbers of functions that boundary elements
/// begin with.
#include "bem/panel_mesh.hpp"

#include <array>
#include <memory>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bem/mesh_size.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"
#include "surface/hidden_surface.hpp"
#include "surface/round_shape.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::PanelMesh;
using namespace test;
using Corner = std::array<double, 3>;

std::set<std::pair<Corner, Corner>> sides_of(const PanelMesh& mesh) {
  std::set<std::pair<Corner, Corner>> result;
  const auto corner = [](const Eigen::Vector3d& point) { return Corner{point.x(), point.y(), point.z()}; };
  for (const detail::Panel& panel : mesh.panels())
    for (std::size_t side = 0; side < 3; ++side)
      result.emplace(corner(panel.corners[side]), corner(panel.corners[(side + 1) % 3]));
  return result;
}

TEST(PanelMesh, KeepsABodyClosedWhereOnePartIsDividedFarMoreThanTheRest) {
  for (const Shape& shape : {Shape(Sphere{1, 10}), Shape(Cylinder{1, 0.5, 12}), Shape(Cone{0.5, 2, 12})}) {
    const auto round = detail::RoundShape::of(shape, Eigen::Isometry3d::Identity());
    PanelMesh mesh;
    mesh.add(0, triangulate(shape), {}, &*round);
    mesh.keep_closed(0);
    for (int time = 0; time < 3; ++time) {
      std::vector<int> steps(mesh.groups().size(), 0);
      steps[0] = 5;
      steps[steps.size() / 2] = 1;
      mesh.refine(steps, Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(mesh.panels().size()), 1));
      EXPECT_EQ(mesh.places_before().size(), mesh.panels().size());
    }
    const auto sides = sides_of(mesh);
    for (const auto& [from, to] : sides)
      ASSERT_TRUE(sides.contains({to, from})) << "a crack, or a side whose halves lie along it";
  }
}

detail::ChargedBodies plate_at(double gap) {
  return detail::charged_bodies(
      scene_of(square(0.1, 0), {object("plate", Plate{0.2, 0.09}, at(0.01, 0, gap))}));
}

TEST(PanelMesh, KeepsTheHollowWallOfAnArcThatTouchesAnotherBodyWhenItsPartsMoveOntoTheRoundShape) {
  const Arc arc{.inner_radius = 0.08, .outer_radius = 0.09, .height = 0.02, .degrees = 60, .segments = 4};
  const Cuboid foot{0.004, 0.004, 0.01};
  const detail::ChargedBodies bodies = detail::charged_bodies(
      above_sensor({object("arc", arc, at(0, 0, 0.05)), object("foot", foot, at(0.085, 0, 0.035))}));
  const detail::BodySurface& surface = bodies.bodies[1].surface;
  PanelMesh mesh(std::make_shared<detail::HiddenSurface>(bodies));
  mesh.add(1, detail::triangles_of(surface), {}, detail::round_shape_of(surface));
  for (int time = 0; time < 2; ++time)
    mesh.refine(std::vector<int>(mesh.groups().size(), 2), Eigen::MatrixXd(mesh.panels().size(), 0));
  double visible = 0;
  for (const detail::Panel& panel : mesh.panels())
    visible += panel.area;
  const double angle = arc.degrees * std::numbers::pi / 180, r = arc.inner_radius, s = arc.outer_radius;
  const double whole = angle * ((s + r) * arc.height + s * s - r * r) + 2 * (s - r) * arc.height;
  EXPECT_NEAR(visible, whole, foot.size_x * foot.size_y);
}

TEST(MeshSize, TheFunctionsInAllAreThoseOfTheFaces) {
  const detail::ChargedBodies bodies = plate_at(0.01);
  const std::array features{1.0, 2.0};
  const std::vector<double> numbers = detail::numbers_of_functions(bodies, features, 5);
  for (std::size_t k = 0; k < features.size(); ++k) {
    double sum = 0;
    for (const detail::FaceFunctions& face : detail::a_priori_functions(bodies, features[k], 5))
      sum += face.count();
    EXPECT_EQ(numbers.at(k), sum);
  }
}

TEST(MeshSize, ACloserPlateNeedsMoreFunctions) {
  const std::array features{1.0};
  EXPECT_EQ(detail::numbers_of_functions(plate_at(1), features, 5).front(), 2 * 25);
  EXPECT_GT(detail::numbers_of_functions(plate_at(0.003), features, 5).front(),
            detail::numbers_of_functions(plate_at(0.03), features, 5).front());
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
