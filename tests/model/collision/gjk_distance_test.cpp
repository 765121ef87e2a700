#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "collision/convex_pair.hpp"
#include "collision/gjk_filter.hpp"
#include "fringe/gjk.hpp"
#include "real.hpp"
#include "shape_pairs.hpp"
#include "simd/dispatch.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using namespace test;

Real point_segment(const RealVector& p, const RealVector& a, const RealVector& b) {
  const RealVector along = b - a;
  const Real length = along.squaredNorm();
  const Real t = length == 0 ? Real(0) : std::clamp(Real((p - a).dot(along) / length), Real(0), Real(1));
  return (a + t * along - p).squaredNorm();
}

/// Computes the squared distance of two segments. If the nearest points of the two lines do not lie inside
/// both segments, an end is nearest, which point_segment covers.
Real segment_segment(const RealVector& a, const RealVector& b, const RealVector& c, const RealVector& d) {
  const RealVector u = b - a, v = d - c, w = a - c;
  const Real uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const Real determinant = uu * vv - uv * uv;
  Real least = std::min(
      {point_segment(a, c, d), point_segment(b, c, d), point_segment(c, a, b), point_segment(d, a, b)});
  if (determinant <= 0)
    return least;
  const Real s = (uv * vw - vv * uw) / determinant, t = (uu * vw - uv * uw) / determinant;
  if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
    least = std::min(least, Real((w + s * u - t * v).squaredNorm()));
  return least;
}

/// Computes the squared distance of a point and a triangle: the distance to the plane if the foot lies
/// inside, otherwise that to the nearest edge.
Real point_triangle(const RealVector& p, const RealVector& a, const RealVector& b, const RealVector& c) {
  const RealVector u = b - a, v = c - a, w = p - a;
  const Real uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const Real determinant = uu * vv - uv * uv;
  Real least = std::min({point_segment(p, a, b), point_segment(p, b, c), point_segment(p, c, a)});
  if (determinant <= 0)
    return least;
  const Real s = (vv * uw - uv * vw) / determinant, t = (uu * vw - uv * uw) / determinant;
  if (s >= 0 && t >= 0 && s + t <= 1)
    least = std::min(least, Real((w - s * u - t * v).squaredNorm()));
  return least;
}

/// Computes the squared distance of two disjoint hulls as the smallest distance between any of their
/// features, from all pairs and triples of vertices; those on the hulls are among them.
Real square_by_features(const Points& a, const Points& b) {
  std::vector<RealVector> p, q;
  for (const Vector3d& point : a)
    p.push_back(point.cast<Real>());
  for (const Vector3d& point : b)
    q.push_back(point.cast<Real>());
  Real least = (p[0] - q[0]).squaredNorm();
  const auto vertices_to_faces = [&](const auto& vertices, const auto& others) {
    for (const RealVector& vertex : vertices)
      for (std::size_t i = 0; i < others.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j)
          for (std::size_t k = 0; k <= j; ++k)
            least = std::min(least, point_triangle(vertex, others[i], others[j], others[k]));
  };
  vertices_to_faces(p, q);
  vertices_to_faces(q, p);
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < q.size(); ++k)
        for (std::size_t l = 0; l < k; ++l)
          least = std::min(least, segment_segment(p[i], p[j], q[k], q[l]));
  return least;
}

double largest_coordinate(const Points& points) {
  double largest = 0;
  for (const Vector3d& point : points)
    largest = std::max(largest, point.cwiseAbs().maxCoeff());
  return largest;
}

class GjkDistanceOnClass : public testing::TestWithParam<PairClass> {};

TEST_P(GjkDistanceOnClass, AgreesWithAllPairsOfFeatures) {
  constexpr std::size_t most_vertices = 5;
  constexpr double three_units = 3 * std::numeric_limits<double>::epsilon();
  Random random(3);
  int disjoint = 0;
  for (int i = 0; i < draws(60); ++i) {
    auto [a, b] = GetParam().make(random);
    a.resize(std::min(a.size(), most_vertices));
    b.resize(std::min(b.size(), most_vertices));
    const GjkDistance found = gjk_distance(a, b);
    ASSERT_EQ(found.distance == 0, gjk_intersects(a, b).intersects) << "pair " << i;
    if (found.distance == 0) {
      ASSERT_EQ(found.witness_a, found.witness_b) << "pair " << i;
      continue;
    }
    ++disjoint;
    const Real expected = sqrt(square_by_features(a, b));
    ASSERT_LE(abs(found.distance - expected), three_units * expected) << "pair " << i;
  }
  EXPECT_GT(disjoint, 0);
}

/// Checks that two witnesses lie in the hulls of their sets and are as far apart as the sets.
void expect_witnesses(const Points& a, const Points& b, const Vector3d& on_a, const Vector3d& on_b,
                      double distance) {
  // One unit in the last place of each coordinate.
  const double rounding =
      2 * std::numeric_limits<double>::epsilon() * std::max(largest_coordinate(a), largest_coordinate(b));
  ASSERT_LE(gjk_distance(a, Points{on_a}).distance, rounding);
  ASSERT_LE(gjk_distance(b, Points{on_b}).distance, rounding);
  ASSERT_NEAR((on_a - on_b).norm(), distance, 4 * rounding);
}

/// Which answers are certain, and their last digits, may depend on the instruction set, no more.
TEST_P(GjkDistanceOnClass, HasWitnessesInTheHullsAtThatDistanceWithEveryInstructionSet) {
  constexpr double three_units = 3 * std::numeric_limits<double>::epsilon();
  Random random(5);
  int apart = 0;
  std::map<std::string_view, int> certain;
  for (int i = 0; i < draws(200); ++i) {
    SCOPED_TRACE(i);
    const auto [a, b] = GetParam().make(random);
    const GjkDistance expected = gjk_distance(a, b);
    expect_witnesses(a, b, expected.witness_a, expected.witness_b, expected.distance);
    apart += expected.distance > 0;
    const detail::PassingHulls hulls(a, b);
    for (const detail::InstructionSet set : detail::available_instruction_sets()) {
      SCOPED_TRACE(name_of(set));
      detail::HullDistance found;
      detail::kernels<detail::GjkFilter>(set).hull_distance(hulls.a().given(), hulls.b().given(), found);
      if (!found.is_certain)
        continue;
      certain[name_of(set)] += expected.distance > 0;
      ASSERT_NEAR(found.distance, expected.distance, three_units * expected.distance);
      expect_witnesses(a, b, Vector3d(found.on_a), Vector3d(found.on_b), expected.distance);
    }
  }
  // Exact numbers remain for few pairs: close ones, thin simplices and coordinates near zero.
  if (GetParam().name != "anywhere")
    return;
  for (const detail::InstructionSet set : detail::available_instruction_sets())
    EXPECT_GE(certain[name_of(set)], 0.95 * apart) << name_of(set);
}

INSTANTIATE_TEST_SUITE_P(Pairs, GjkDistanceOnClass,
                         testing::ValuesIn(pair_classes().begin(), pair_classes().end()),
                         [](const auto& instance) { return instance.param.name; });

TEST(GjkDistance, EqualsKnownDistances) {
  const Points square{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  for (const double height : {3.0, 0x1p-40, 1e-300, 1e300}) {
    const GjkDistance found = gjk_distance(square, Points{{0.25, 0.5, height}});
    EXPECT_EQ(found.distance, height);
    EXPECT_EQ(found.witness_a, Vector3d(0.25, 0.5, 0));
    EXPECT_EQ(found.witness_b, Vector3d(0.25, 0.5, height));
  }
  EXPECT_EQ(gjk_distance(square, Points{{4, 5, 0}}).distance, 5);              // (1, 1) to (4, 5)
  EXPECT_EQ(gjk_distance(square, Points{{4, -2, 4}, {4, 2, 4}}).distance, 5);  // edge to edge
  EXPECT_EQ(gjk_distance(square, Points{{-4, 0, 0}, {4, 0, 0}}).distance, 0);
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(gjk_distance(square, Points{{0, 0, tiny}}).distance, tiny);
  constexpr double huge = std::numeric_limits<double>::max();
  EXPECT_EQ(gjk_distance(Points{{-huge, 0, 0}}, Points{{huge, 0, 0}}).distance,
            std::numeric_limits<double>::infinity());
}

/// The four vertices of a face lie in a plane but for their rounding: which of them are nearest is decided by
/// that.
TEST(GjkDistance, OfTurnedCuboidsIsAsAccurate) {
  constexpr double three_units = 3 * std::numeric_limits<double>::epsilon();
  Random random(6);
  const auto cuboid = [&](const Vector3d& place) {
    const Points corners = corners_of_box(random.in_box({0.2, 0.2, 0.2}, {1, 1, 1}));
    return moved(corners, Eigen::Translation3d(place) * Eigen::Isometry3d(random.rigid_motion().linear()));
  };
  for (int i = 0; i < draws(20); ++i) {
    const Points a = cuboid(Vector3d::Zero()), b = cuboid(random.in_box({3.5, -2, -2}, {3.6, 2, 2}));
    const Real expected = sqrt(square_by_features(a, b));
    const GjkDistance found = gjk_distance(a, b);
    ASSERT_LE(abs(found.distance - expected), three_units * expected) << "pair " << i;
    ASSERT_TRUE(found.exact);
  }
}

/// Blocks hold eight vertices, so that lists of all lengths up to some blocks are filled up differently.
TEST(GjkDistance, ArrangesVerticesInBlocksWithEveryInstructionSet) {
  constexpr std::size_t block = detail::VertexBlocks::size, most_vertices = 20;
  Random random(7);
  const Vector3d origin = random.in_box({-1, -1, -1}, {1, 1, 1});
  Points points;
  for (std::size_t count = 1; count <= most_vertices; ++count) {
    points.push_back(random.in_box({-1, -1, -1}, {1, 1, 1}));
    const std::size_t filled = (count + block - 1) / block * block;
    for (const detail::InstructionSet set : detail::available_instruction_sets()) {
      const detail::GjkFilter& filter = detail::kernels<detail::GjkFilter>(set);
      std::vector<double> blocks(3 * filled);
      Vector3d centre, mean = Vector3d::Zero();
      const double largest =
          filter.arrange(points.data()->data(), count, origin.data(), blocks.data(), centre.data());
      double expected_largest = 0;
      for (std::size_t i = 0; i < filled; ++i) {
        const Vector3d expected = points[std::min(i, count - 1)] - origin;
        expected_largest = std::max(expected_largest, expected.cwiseAbs().maxCoeff());
        mean += expected / static_cast<double>(filled);
        for (std::size_t k = 0; k < 3; ++k)
          ASSERT_EQ(blocks[i / block * 3 * block + k * block + i % block],
                    expected[static_cast<Eigen::Index>(k)])
              << name_of(set) << ", " << count << " vertices";
      }
      EXPECT_EQ(largest, expected_largest) << name_of(set) << ", " << count << " vertices";
      EXPECT_LE((centre - mean).norm(), 1e-15) << name_of(set) << ", " << count << " vertices";
      for (const float spoilt : {NAN, INFINITY}) {
        Points others = points;
        others[below(random, count)][1] = spoilt;
        EXPECT_FALSE(std::isfinite(
            filter.arrange(others.data()->data(), count, origin.data(), blocks.data(), centre.data())))
            << name_of(set) << ", " << count << " vertices";
      }
    }
  }
}

/// Where rounding decides which vertices of a flat face are nearest, the distance hardly depends on the
/// choice, but the witnesses do.
TEST(GjkDistance, HasTheWitnessesOfExactNumbers) {
  const PairClass& anywhere = pair_classes().front();
  ASSERT_EQ(anywhere.name, "anywhere");
  const auto units = [](const Vector3d& found, const Vector3d& expected) {
    double most = 0;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double size = std::abs(expected[k]);
      most = std::max(most, std::abs(found[k] - expected[k]) / (std::nextafter(size, INFINITY) - size));
    }
    return most;
  };
  Random random(11);
  for (int i = 0; i < draws(300); ++i) {
    const auto [a, b] = anywhere.make(random);
    const GjkDistance found = gjk_distance(a, b);
    if (found.distance == 0)
      continue;
    const GjkDistance exact = exact_distance(a, b);
    ASSERT_LE(units(found.witness_a, exact.witness_a), 1) << "pair " << i;
    ASSERT_LE(units(found.witness_b, exact.witness_b), 1) << "pair " << i;
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
