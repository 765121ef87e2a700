#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "conditioning.hpp"
#include "triangle_classes.hpp"
#include "truth.hpp"

/// Compares the conditioning, which comes from derivatives, with the change that a unit in the last place
/// really causes.
namespace fringe::stress::FRINGE_TEST_FILE {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

DoubleDouble integral(const Triangle& triangle, const Rectangle& plate) {
  const Truth truth = integrate(dissect(triangle, plate));
  EXPECT_TRUE(truth.converged);
  return truth.value;
}

/// Computes the largest relative change when each of the 18 numbers is replaced by its neighbours.
double largest_change(Triangle triangle, Rectangle plate) {
  const DoubleDouble value = integral(triangle, plate);
  double largest = 0;
  for (Eigen::Vector3d* vector :
       {triangle.data(), &triangle[1], &triangle[2], &plate.corner, &plate.edge_u, &plate.edge_v})
    for (double& number : *vector)
      for (const double towards : {-infinity, infinity}) {
        const double original = number;
        number = std::nextafter(number, towards);
        largest = std::max(largest, std::abs((integral(triangle, plate) - value).high / value.high));
        number = original;
      }
  return largest;
}

class Conditioning : public testing::TestWithParam<std::string> {};

TEST_P(Conditioning, IsWhatAUnitInTheLastPlaceChanges) {
  for (const Group& group : make_triangles(GetParam(), 8, 3))
    for (const Triangle& triangle : group.triangles) {
      const double expected = largest_change(triangle, group.plate);
      const Dissection dissection = dissect(triangle, group.plate);
      const double estimate =
          conditioning(dissection, triangle, group.plate, integrate(dissection).value.high);
      EXPECT_LE(estimate, 1.01 * expected);
      EXPECT_GE(estimate, 0.97 * expected);
    }
}

INSTANTIATE_TEST_SUITE_P(Classes, Conditioning,
                         testing::Values("random", "region-1", "region-2", "region-3", "nine-cells", "sliver",
                                         "parallel", "near-plate", "near-edge", "near-corner",
                                         "passing-closely", "far", "one-kilometre-away", "one-micrometre",
                                         "huge", "plane-through-corner", "plane-through-edge"),
                         [](const auto& name) {
                           std::string text = name.param;
                           std::replace(text.begin(), text.end(), '-', '_');
                           return text;
                         });

}  // namespace
}  // namespace fringe::stress::FRINGE_TEST_FILE
