/// Tests the panels of surfaces, how they are divided, and the numbers of functions that boundary elements
/// begin with.
#include "bem/panel_mesh.hpp"

#include <array>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bem/mesh_size.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::PanelMesh;
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
  return detail::charged_bodies(test::scene_of(
      test::square(0.1, 0), {test::object("plate", Plate{0.2, 0.09}, test::at(0.01, 0, gap))}));
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
