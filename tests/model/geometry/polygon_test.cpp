#include "geometry/polygon.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::defect_of_polygon;
using detail::triangles_of_polygon;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Vertices = std::vector<Vector2d>;

const Vertices l_shape{{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {0, 1}};

TEST(Polygons, AreDividedByClippingEarsInTheOrderOfTheFormat) {
  const std::vector<Triangle> triangles = triangles_of_polygon(l_shape);
  const std::vector<Triangle> expected{{Vector3d{0, 1, 0}, {0, 0, 0}, {2, 0, 0}},
                                       {Vector3d{2, 0, 0}, {2, 2, 0}, {1, 2, 0}},
                                       {Vector3d{2, 0, 0}, {1, 2, 0}, {1, 1, 0}},
                                       {Vector3d{0, 1, 0}, {2, 0, 0}, {1, 1, 0}}};
  EXPECT_EQ(triangles, expected);
}

TEST(Polygons, HaveTheirNormalsAlongZInEitherOrder) {
  const Vertices clockwise(l_shape.rbegin(), l_shape.rend());
  EXPECT_EQ(triangles_of_polygon(clockwise).size(), 4U);
  for (const auto& [a, b, c] : triangles_of_polygon(clockwise))
    EXPECT_GT((b - a).cross(c - a).z(), 0);
}

TEST(Polygons, WithVerticesInTheMiddleOfSidesHaveNoTriangleWithoutArea) {
  const Vertices square{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  const std::vector<Triangle> triangles = triangles_of_polygon(square);
  EXPECT_EQ(triangles.size(), 6U);
  for (const Triangle& triangle : triangles)
    EXPECT_GT(area(std::vector{triangle}), 0.4);
  EXPECT_DOUBLE_EQ(area(triangles), 4);
}

TEST(Polygons, OfManyVerticesKeepTheirArea) {
  Vertices star;
  double doubled = 0;
  constexpr int n = 400;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * std::acos(-1) * k / n, radius = k % 2 == 0 ? 1 : 0.3;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  for (int k = 0; k < n; ++k) {
    const Vector2d &a = star[static_cast<std::size_t>(k)], &b = star[static_cast<std::size_t>((k + 1) % n)];
    doubled += a.x() * b.y() - a.y() * b.x();
  }
  const std::vector<Triangle> triangles = triangles_of_polygon(star);
  EXPECT_EQ(triangles.size(), n - 2U);
  EXPECT_NEAR(area(triangles), doubled / 2, 1e-13);
}

TEST(Polygons, ThatAreNotSimpleAreRefusedWithAReason) {
  const auto reason = [](const Vertices& vertices) { return defect_of_polygon(vertices).value_or("none"); };
  EXPECT_EQ(reason(l_shape), "none");
  EXPECT_EQ(reason({{0, 0}, {1, 0}}), "must have 3 to 500 vertices, not 2");
  EXPECT_EQ(reason({{0, 0}, {1, 0}, {1, 1}, {1, 0}}), "vertex 3 repeats vertex 1");
  EXPECT_EQ(reason({{0, 0}, {1, 1}, {2, 2}, {3, 3}}), "the vertices lie on a line, and enclose no area");
  EXPECT_EQ(reason({{0, 0}, {1, 1}, {1, 0}, {0, 1}}),
            "edge 0 (from vertex 0) meets edge 2: the outline must not cross or touch itself");
  // A vertex that touches a side, and a spike.
  EXPECT_EQ(reason({{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}),
            "edge 0 (from vertex 0) meets edge 2: the outline must not cross or touch itself");
  EXPECT_EQ(reason({{0, 0}, {2, 0}, {1, 0}, {0, 1}}),
            "edge 0 (from vertex 0) meets edge 1: the outline must not cross or touch itself");
  EXPECT_THROW(triangles_of_polygon(Vertices{{0, 0}, {1, 1}, {1, 0}, {0, 1}}), InputError);
}

/// A vertex one unit in the last place to either side of a line; the products round to the same number.
TEST(Polygons, AreJudgedExactly) {
  const double on = 0.1 + 0.2;
  for (const double y : {std::nextafter(on, 0.0), on, std::nextafter(on, 1.0)}) {
    const Vertices vertices{{0, 0}, {3 * on, 3 * on}, {-1, 1}, {on, y}};
    EXPECT_EQ(defect_of_polygon(vertices).has_value(), y <= on) << y;
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
