#include "fringe/surface_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "integral/facing.hpp"
#include "integral/tree/build.hpp"
#include "integral/tree/node_bound.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::Random;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Allowance for rounding beyond the bound, as a share of the value.
constexpr double rounding = 1e-13;

/// Returns triangles of all sizes, some of them duplicated, some without area.
std::vector<Triangle> soup(Random& random, int count) {
  std::vector<Triangle> triangles;
  while (static_cast<int>(triangles.size()) < count) {
    const double size = std::pow(10, random.uniform(-3, 0));
    const Vector3d place = random.in_box({-1, -1, -1}, {1, 1, 1});
    const Triangle triangle = random.triangle_in_box(place, place + Vector3d::Constant(size));
    triangles.push_back(triangle);
    if (triangles.size() % 5 == 0)
      triangles.push_back(triangle);
    if (triangles.size() % 7 == 0)
      triangles.push_back({triangle[0], triangle[1], triangle[1]});
  }
  return triangles;
}

struct NamedMesh {
  std::string name;
  std::vector<Triangle> triangles;
};

/// Returns closed, open, flat, thick, coarse and fine surfaces of about one metre in size.
std::vector<NamedMesh> meshes() {
  Random random(1);
  std::vector<NamedMesh> result{
      {"sphere", triangulate(Sphere{0.5, 48})},
      {"cuboid", triangulate(Cuboid{0.4, 0.7, 1})},
      {"cylinder", triangulate(Cylinder{0.2, 0.8, 64})},
      {"plate", triangulate(Plate{0.6, 0.4})},
      {"triangle", {random.triangle_in_box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5})}},
      {"large soup", soup(random, 1500)},
      {"small soup", soup(random, 40)},
  };
  // A sheet of many small triangles, both flat and fine.
  std::vector<Triangle> sheet;
  constexpr int cells = 30;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (const Triangle& half : test::parallelogram(Vector3d(i, j, 0) / cells, Vector3d(1, 0, 0) / cells,
                                                      Vector3d(0, 1, 0) / cells))
        sheet.push_back(half);
  result.push_back({"sheet", sheet});
  return result;
}

/// Returns a plate of random size at a random distance from a surface about the origin, near or far.
Rectangle any_plate(Random& random) {
  const double size = std::pow(10, random.uniform(-2, 0.5)),
               distance = std::pow(10, random.uniform(-0.5, 1.5));
  const Rectangle plate{Vector3d::Zero(), {size, 0, 0}, {0, size * random.uniform(0.2, 1), 0}};
  Eigen::Isometry3d motion = random.rigid_motion();
  motion.translation() = distance * random.in_box({-1, -1, -1}, {1, 1, 1});
  return transformed(plate, motion);
}

void expect_covered(const TreeIntegral& integral, double truth, double tolerance) {
  if (std::isinf(truth)) {
    EXPECT_EQ(integral.value, infinity);
    EXPECT_EQ(integral.bound, 0);
    return;
  }
  EXPECT_LE(std::abs(integral.value - truth), integral.bound + rounding * truth);
  EXPECT_LE(integral.bound, tolerance * truth * (1 + rounding));
}

void expect_every_triangle_counted(const TreeCounts& counts, std::size_t triangles) {
  EXPECT_EQ(counts.triangles_evaluated + counts.triangles_lumped + counts.triangles_skipped, triangles);
}

/// Returns the triangles that count by a rule.
std::vector<Triangle> counting(const std::vector<Triangle>& triangles, const Rectangle& plate,
                               FaceRule rule) {
  std::vector<Triangle> result;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(result), [&](const Triangle& triangle) {
    return rule == FaceRule::all || detail::sight(triangle, plate) == detail::Sight::outward;
  });
  return result;
}

TEST(SurfaceTree, BoundCoversTheErrorAndKeepsTheToleranceByEveryRule) {
  constexpr int poses = 25;
  int touching = 0;
  Random random(2);
  for (const auto& [name, triangles] : meshes()) {
    SCOPED_TRACE(name);
    const SurfaceTree tree(triangles);
    for (int i = 0; i < poses; ++i) {
      const Rectangle plate = any_plate(random);
      const bool touches = std::isinf(test::total_integral(triangles, plate));
      touching += touches ? 1 : 0;
      for (const FaceRule rule : {FaceRule::all, FaceRule::facing}) {
        if (touches && rule == FaceRule::facing)
          continue;
        const std::vector<Triangle> faces = counting(triangles, plate, rule);
        const double truth = test::total_integral(faces, plate);
        for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 0.0}) {
          SCOPED_TRACE(fmt::format("pose {}, tolerance {}", i, tolerance));
          const TreeIntegral integral = tree.integrate(plate, tolerance, 0, rule);
          expect_covered(integral, truth, tolerance);
          expect_every_triangle_counted(integral.counts, triangles.size());
          EXPECT_GE(integral.counts.triangles_skipped, triangles.size() - faces.size());
        }
      }
    }
  }
  EXPECT_GT(touching, 5);
}

TEST(SurfaceTree, BoundCoversTheErrorNextToThePlate) {
  const std::vector<Triangle> triangles = triangulate(Sphere{0.5, 64});
  const SurfaceTree tree(triangles);
  Random random(3);
  for (const double gap : {1e-6, 1e-4, 1e-2, 1e-1}) {
    for (int i = 0; i < 10; ++i) {
      const Vector3d shift(random.uniform(-0.6, 0.2), random.uniform(-0.6, 0.2), 0.5 + gap);
      const Rectangle plate{shift, {0.4, 0, 0}, {0, 0.4, 0}};
      const double truth = test::total_integral(triangles, plate);
      for (const double tolerance : {1e-3, 1e-6}) {
        SCOPED_TRACE(fmt::format("gap {}, position {}, tolerance {}", gap, i, tolerance));
        expect_covered(tree.integrate(plate, tolerance), truth, tolerance);
      }
    }
  }
}

TEST(SurfaceTree, LumpsWhatIsFarUnlessWithoutTolerance) {
  const std::vector<Triangle> triangles = triangulate(Sphere{0.5, 128});
  const SurfaceTree tree(triangles);
  const Rectangle plate{{20, 20, 20}, {0.1, 0, 0}, {0, 0.1, 0}};
  const TreeIntegral integral = tree.integrate(plate, 1e-4), exact = tree.integrate(plate, 0);
  EXPECT_EQ(integral.counts.triangles_lumped, triangles.size());
  EXPECT_EQ(integral.counts.nodes_visited, 1U);
  EXPECT_LE(integral.counts.points, 60U);
  EXPECT_EQ(exact.counts.triangles_evaluated, triangles.size());
  EXPECT_EQ(exact.bound, 0);
}

TEST(SurfaceTree, AllowanceAddsToTheTolerance) {
  const std::vector<Triangle> triangles = triangulate(Sphere{0.5, 64});
  const SurfaceTree tree(triangles);
  Random random(4);
  for (int i = 0; i < 30; ++i) {
    const Rectangle plate = any_plate(random);
    const double truth = test::total_integral(triangles, plate);
    if (std::isinf(truth))
      continue;
    for (const double tolerance : {0.0, 1e-6}) {
      const double allowance = 1e-3 * truth;
      const TreeIntegral integral = tree.integrate(plate, tolerance, allowance);
      EXPECT_LE(std::abs(integral.value - truth), integral.bound + rounding * truth);
      EXPECT_LE(integral.bound, (tolerance * truth + allowance) * (1 + rounding));
      EXPECT_LE(integral.counts.nodes_visited, tree.integrate(plate, 1e-6).counts.nodes_visited);
    }
  }
}

TEST(SurfaceTree, OfTrianglesWithoutAreaIsZero) {
  const Vector3d a(0, 0, 0), b(1, 0, 0);
  const TreeIntegral integral = SurfaceTree(std::vector<Triangle>{{a, b, b}, {a, a, a}})
                                    .integrate({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1e-3);
  EXPECT_EQ(integral.value, 0);
  EXPECT_EQ(integral.bound, 0);
  EXPECT_EQ(integral.counts.triangles_skipped, 2U);
}

TEST(SurfaceTree, RefusesWhatCannotBeIntegrated) {
  EXPECT_THROW(SurfaceTree(std::vector<Triangle>{}), InputError);
  const Vector3d a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_THAT(
      [&] {
        SurfaceTree(std::vector<Triangle>{{a, b, c}, {a, b, {0, infinity, 0}}});
      },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("triangle 1: vertex 2")));
  const SurfaceTree tree(std::vector<Triangle>{{a, b, c}});
  const Rectangle plate{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW(tree.integrate({{0, 0, 1}, {1, 0, 0}, {1, 1, 0}}, 0), InputError);
  for (const double bad : {-1e-3, infinity, std::nan("")}) {
    EXPECT_THROW(tree.integrate(plate, bad), InputError);
    EXPECT_THROW(tree.integrate(plate, 0, bad), InputError);
  }
}

/// Computes ∫(direction·(p − centre))^power dA in closed form.
double integral_of_power(const std::vector<Triangle>& triangles, const Vector3d& centre,
                         const Vector3d& direction, int power) {
  // ∫ (n·δ)^k dA = 2A · k!/(k+2)! · Σ_{i+j+l=k} a^i b^j c^l, with a, b, c the values of n·δ at the corners.
  double sum = 0;
  for (const Triangle& triangle : triangles) {
    const double a = direction.dot(triangle[0] - centre), b = direction.dot(triangle[1] - centre),
                 c = direction.dot(triangle[2] - centre);
    double products = 0;
    for (int i = 0; i <= power; ++i)
      for (int j = 0; i + j <= power; ++j)
        products += std::pow(a, i) * std::pow(b, j) * std::pow(c, power - i - j);
    sum += twice_area(triangle) * products / ((power + 1) * (power + 2));
  }
  return sum;
}

TEST(SurfaceTree, MomentsOfEveryNodeAreWithinTheStatedMismatch) {
  Random random(7);
  for (const auto& [name, triangles] : meshes()) {
    SCOPED_TRACE(name);
    const detail::SurfaceNodes tree = detail::build_nodes(triangles);
    for (const detail::Node& node : tree.nodes) {
      std::vector<Triangle> part;
      for (std::size_t i = 0; i < node.triangles.count; ++i)
        part.push_back(tree.triangles[node.triangles.first + i]);
      const Vector3d direction = random.in_box({-1, -1, -1}, {1, 1, 1}).normalized();
      for (std::size_t step = 0; step < node.quadratures.size(); ++step) {
        const detail::Range& points = node.quadratures[step];
        if (points.count == 0)
          continue;
        for (int power = 0; power <= detail::highest_degree; ++power) {
          double sum = 0;
          for (std::size_t i = points.first; i < points.first + points.count; ++i) {
            const Vector3d point(tree.points.x[i], tree.points.y[i], tree.points.z[i]);
            sum += tree.points.weight[i] * std::pow(direction.dot(point - node.centre), power);
          }
          const double scale = node.area * std::pow(node.radius, power);
          EXPECT_NEAR(sum, integral_of_power(part, node.centre, direction, power),
                      (node.errors.mismatch[static_cast<std::size_t>(power)][step] + rounding) * scale);
        }
        // Moments that are not matched must be small, or the quadratures would be of no use.
        EXPECT_LE(node.errors.mismatch[0][step], 1e-4);
      }
    }
  }
}

/// Returns an equilateral triangle of a given, small area about a point, in a plane of constant z.
Triangle small_triangle(const Vector3d& place, double area) {
  const double size = std::sqrt(4 * area / std::sqrt(27.0));
  Triangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = 2 * std::acos(-1.0) * static_cast<double>(k) / 3;
    triangle[k] = place + size * Vector3d(std::cos(angle), std::sin(angle), 0);
  }
  return triangle;
}

/// Returns two spots whose centroid is the origin: the lighter one lies one metre from it.
std::vector<Triangle> two_spots(const Vector3d& towards_lighter, double heavier) {
  return {small_triangle(-towards_lighter / heavier, 1e-8 * heavier), small_triangle(towards_lighter, 1e-8)};
}

/// Checks that the error of a quadrature of a tree with one node is within its bound and at least a fifth of
/// it.
void expect_nearly_attained(const std::vector<Triangle>& triangles, const Rectangle& plate,
                            std::size_t step) {
  const detail::SurfaceNodes tree = detail::build_nodes(triangles);
  const detail::Node& node = tree.nodes.front();
  const detail::PlateFrame frame = detail::plate_frame(plate);
  const detail::Placement placement = detail::place(frame, node.centre);
  double sum = 0;
  const detail::Range& points = node.quadratures[step];
  for (std::size_t i = points.first; i < points.first + points.count; ++i)
    sum += tree.points.weight[i] /
           detail::place(frame, {tree.points.x[i], tree.points.y[i], tree.points.z[i]}).distance;
  const double error = std::abs(sum - test::total_integral(triangles, plate)),
               bound =
                   detail::smooth_errors(placement, node)[step] + detail::kink_error(frame, placement, node);
  EXPECT_LE(error, bound);
  EXPECT_GE(error, bound / 5);
}

TEST(SurfaceTree, BoundIsNearlyAttainedByTwoSpots) {
  const auto wide_plate = [](double height) {
    return Rectangle{{-1e4, -1e4, height}, {2e4, 0, 0}, {0, 2e4, 0}};
  };
  // One above the other, all forms of the expansion take their largest values. At a large distance the first
  // unmatched term dominates the bound; at 1.05 radii the remainder does.
  for (const double heavier : {1.0, 4.0})
    for (const double distance : {1.05, 1.2, 2.0, 10.0, 100.0}) {
      SCOPED_TRACE(fmt::format("heavier {}, distance {}", heavier, distance));
      expect_nearly_attained(two_spots({0, 0, 1}, heavier), wide_plate(distance), 0);
    }
  // The four points of the rule of degree 2 are symmetric, spots of unequal weight are not: the term of
  // degree 3 remains.
  for (const double distance : {20.0, 100.0})
    expect_nearly_attained(two_spots({0, 0, 1}, 9), wide_plate(distance), 1);
  // In front of the plate the distance of a surface parallel to it is constant: all of the error comes from
  // the lighter spot beyond the border plane.
  for (const double distance : {200.0, 1000.0})
    expect_nearly_attained(two_spots({1, 0, 0}, 20), {{-5000, -5000, -distance}, {5000, 0, 0}, {0, 10000, 0}},
                           1);
}

TEST(SurfaceTree, BoundDoesNotDependOnTheUnitOfLength) {
  const std::vector<Triangle> triangles = triangulate(Sphere{0.5, 32});
  const Rectangle plate{{0.4, -0.3, 0.9}, {1, 0, 0}, {0, 1, 0}};
  const TreeIntegral expected = SurfaceTree(triangles).integrate(plate, 1e-4);
  for (const double scale : {std::ldexp(1.0, -120), std::ldexp(1.0, 120)}) {
    std::vector<Triangle> scaled = triangles;
    for (Triangle& triangle : scaled)
      for (Vector3d& vertex : triangle)
        vertex *= scale;
    const TreeIntegral integral = SurfaceTree(scaled).integrate(
        {scale * plate.corner, scale * plate.edge_u, scale * plate.edge_v}, 1e-4);
    EXPECT_NEAR(integral.value / scale, expected.value, rounding * expected.value);
    EXPECT_NEAR(integral.bound / scale, expected.bound, rounding * expected.value);
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
