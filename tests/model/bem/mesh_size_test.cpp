/// Tests the numbers of functions that boundary elements begin with.

#include "bem/mesh_size.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

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
