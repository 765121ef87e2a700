/// Moments of surfaces and the few points that stand for them in the tree, against quadrature in closed form.

#include "integral/tree/moments.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "integral/tree/compression.hpp"
#include "integral/tree/monomial_rows.hpp"
#include "integral/tree/monomials.hpp"
#include "integral/tree/partition.hpp"
#include "integral/tree/weighted_point.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

double area_of(const Triangle& triangle) {
  return (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm() / 2;
}

std::vector<WeightedPoint> points_on(const std::vector<Triangle>& surface) {
  std::vector<WeightedPoint> points;
  for (const Triangle& triangle : surface)
    append_rule(triangle, area_of(triangle), points);
  return points;
}

double power(const Vector3d& p, const Monomial& monomial) {
  return std::pow(p.x(), monomial.exponents[0]) * std::pow(p.y(), monomial.exponents[1]) *
         std::pow(p.z(), monomial.exponents[2]);
}

TEST(Monomials, AreAllOfTheirDegreesAndAddUpToPowersOfTheSum) {
  const Vector3d p(0.3, -0.7, 0.9);
  std::vector<double> sums(moment_degree + 1);
  int before = 0;
  for (std::size_t k = 0; k < all_monomials; ++k) {
    const auto& [exponents, degree, factor, axis, multinomial] = monomials[k];
    EXPECT_EQ(exponents[0] + exponents[1] + exponents[2], degree);
    EXPECT_EQ(monomial_index(exponents[0], exponents[1], exponents[2]), k);
    EXPECT_GE(degree, before);
    before = degree;
    if (degree > 0) {
      EXPECT_NEAR(power(p, monomials[k]), power(p, monomials[factor]) * p[axis], 1e-15);
    }
    sums[static_cast<std::size_t>(degree)] += multinomial * power(p, monomials[k]);
  }
  for (int degree = 0; degree <= moment_degree; ++degree)
    EXPECT_NEAR(sums[static_cast<std::size_t>(degree)], std::pow(p.sum(), degree), 1e-14);
}

// The moments of a flat square over [0, 1]²: 1/((a + 1)(b + 1)).
TEST(Moments, OfASquareAreThoseOfItsClosedFormUpToDegreeFive) {
  const std::vector<WeightedPoint> points = points_on(test::parallelogram({0, 0, 1}, {1, 0, 0}, {0, 1, 0}));
  const Moments found = moments_of(points, {});
  for (std::size_t k = 0; k < monomial_count(highest_degree); ++k) {
    const auto& exponents = monomials[k].exponents;
    EXPECT_NEAR(found[k], 1.0 / ((exponents[0] + 1) * (exponents[1] + 1)), 1e-14) << k;
  }
  MonomialValues sums{};
  MonomialRows(points, Vector3d::Zero(), Eigen::Matrix3d::Identity(), moment_degree,
               MonomialRows::Factor::weight)
      .add_up(sums);
  for (std::size_t k = 0; k < all_monomials; ++k)
    EXPECT_NEAR(sums[k], found[k], 1e-15) << k;
}

TEST(Moments, MoveWithTheirFrame) {
  const std::vector<WeightedPoint> points = points_on(triangulate(Cone{1, 2, 8}));
  const MomentFrame here{{0.1, -0.2, 0.3}, 1.5}, there{{-0.4, 0.2, -0.5}, 2.5};
  const Moments direct = moments_of(points, there);
  Moments moved{};
  add_translated(moments_of(points, here), here, there, moved);
  for (std::size_t k = 0; k < all_monomials; ++k)
    EXPECT_NEAR(moved[k], direct[k], 1e-13) << k;
}

TEST(Compression, KeepsTheMomentsWithFewPoints) {
  const std::vector<WeightedPoint> all = points_on(triangulate(Sphere{1, 12}));
  double area = 0;
  for (const WeightedPoint& point : all)
    area += point.weight;
  const CompressionFrame frame{Vector3d::Zero(), Eigen::Matrix3d::Identity(), 1};
  std::size_t before = 0;
  for (const int degree : {2, 3, 5}) {
    const std::vector<WeightedPoint> few = compress(all, frame, degree);
    EXPECT_GE(few.size(), before);
    EXPECT_LE(few.size(), monomial_count(degree));
    before = few.size();
    const Moments kept = moments_of(few, {}), expected = moments_of(all, {});
    for (std::size_t k = 0; k < monomial_count(degree); ++k)
      EXPECT_NEAR(kept[k], expected[k], 1e-3 * area) << degree << ": " << k;
    for (const WeightedPoint& point : few)
      EXPECT_GT(point.weight, -0.01 * area / static_cast<double>(few.size()));
  }
}

TEST(Partition, HasEveryTriangleOfPositiveAreaInOneLeaf) {
  std::vector<Triangle> triangles = triangulate(Sphere{1, 16});
  const std::size_t count = triangles.size();
  triangles.push_back({Vector3d(1, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)});
  const Partition found = partition(triangles);
  ASSERT_EQ(found.triangles.size(), count);
  std::vector<int> leaves(count);
  for (const Node& node : found.nodes) {
    if (node.first_child != no_child) {
      // Two children share the triangles.
      const Range &left = found.nodes[node.first_child].triangles,
                  &right = found.nodes[node.first_child + 1].triangles;
      EXPECT_EQ(left.first, node.triangles.first);
      EXPECT_EQ(left.first + left.count, right.first);
      EXPECT_EQ(left.count + right.count, node.triangles.count);
      continue;
    }
    EXPECT_LE(node.triangles.count, most_triangles_in_leaf);
    for (std::size_t k = 0; k < node.triangles.count; ++k)
      ++leaves[node.triangles.first + k];
  }
  EXPECT_TRUE(std::all_of(leaves.begin(), leaves.end(), [](int times) { return times == 1; }));
  double area = 0, expected = 0;
  for (const Triangle& triangle : found.triangles)
    area += area_of(triangle);
  for (const Triangle& triangle : triangles)
    expected += area_of(triangle);
  EXPECT_NEAR(area, expected, 1e-12);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
