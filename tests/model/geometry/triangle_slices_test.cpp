/// A triangle cut by the levels of an affine function: the parts make it up, and each has the values that its
/// name says.

#include "geometry/triangle_slices.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

double area_of(const Triangle& triangle) {
  return (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm() / 2;
}

TEST(TriangleSlices, MakeUpTheTriangleAndLieBetweenTheirLevels) {
  test::Random random(1);
  constexpr double rounding = 1e-12;
  for (int i = 0; i < 500; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Vector3d gradient = random.in_box({-1, -1, -1}, {1, 1, 1});
    const auto value = [&](const Vector3d& point) { return gradient.dot(point); };
    const double a = random.uniform(-1, 1), b = random.uniform(-1, 1), low = std::min(a, b),
                 high = std::max(a, b);
    const Slices parts =
        slices(triangle, {value(triangle[0]), value(triangle[1]), value(triangle[2])}, low, high);
    double sum = 0;
    const auto expect_between = [&](const Slice& slice, double from, double to) {
      for (const Triangle& part : slice) {
        sum += area_of(part);
        for (const Vector3d& corner : part)
          EXPECT_TRUE(value(corner) > from - rounding && value(corner) < to + rounding);
      }
    };
    expect_between(parts.below, -10, low);
    expect_between(parts.between, low, high);
    expect_between(parts.above, high, 10);
    EXPECT_NEAR(sum, area_of(triangle), rounding);
  }
}

TEST(TriangleSlices, ATriangleAtALevelIsNotBetween) {
  const Triangle triangle{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  for (const double level : {2.0, 3.0}) {
    const Slices parts = slices(triangle, Vector3d::Constant(level), 2, 3);
    EXPECT_EQ(parts.between.size, 0U);
    EXPECT_EQ(parts.below.size + parts.above.size, 1U);
  }
}

TEST(TriangleSlices, HalvesAreEqualAndNoLongerThanTheTriangle) {
  test::Random random(2);
  const auto longest = [](const Triangle& triangle) {
    return std::max({(triangle[1] - triangle[0]).norm(), (triangle[2] - triangle[1]).norm(),
                     (triangle[0] - triangle[2]).norm()});
  };
  for (int i = 0; i < 100; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    for (const Triangle& half : halves(triangle)) {
      // The half has the same normal, seen from the same side.
      const Vector3d own = (half[1] - half[0]).cross(half[2] - half[0]);
      EXPECT_LT((own - normal / 2).norm(), 1e-12);
      EXPECT_LT(longest(half), longest(triangle));
    }
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
