#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include <gmock/gmock.h>

#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "fringe/thesis.hpp"
#include "shape_pairs.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using namespace test;

constexpr double infinity = std::numeric_limits<double>::infinity();
const Points tetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

bool intersect(const Points& a, const Points& b) {
  const GjkAnswer answer = gjk_intersects(a, b);
  EXPECT_TRUE(proves(answer, a, b));
  return answer.intersects;
}

// The program collision_stress compares the answers with linear programming, also in other units of length.
TEST(GjkIntersects, AnswersTheSameInTheSmallestAndTheLargestUnitsOfLength) {
  Random random(2);
  for (const PairClass& pair_class : pair_classes()) {
    SCOPED_TRACE(pair_class.name);
    constexpr int pairs = draws(100);
    int intersecting = 0;
    for (int i = 0; i < pairs; ++i) {
      const ShapePair pair = pair_class.make(random);
      const bool expected = intersect(pair.a, pair.b);
      for (const int exponent : {-500, 500}) {
        const auto [a, b] = placed(pair, std::ldexp(1.0, exponent), Vector3d::Zero());
        ASSERT_EQ(intersect(a, b), expected) << "pair " << i << ", 2^" << exponent;
      }
      intersecting += expected;
    }
    // A class with only one kind of answer would show little.
    EXPECT_GT(intersecting, pair_class.name == "mixed_magnitudes" ? 0 : pairs / 20);
    EXPECT_LT(intersecting, pair_class.name == "nested" ? pairs + 1 : pairs * 19 / 20);
  }
}

TEST(GjkIntersects, CountsTouchingAtAVertexAnEdgeAndAFace) {
  for (const Vector3d& step : {Vector3d(1, 0, 0), Vector3d(0.5, 0.5, 0), Vector3d(0.25, 0.25, 0.5)}) {
    Points moved, beyond;
    for (const Vector3d& vertex : tetrahedron) {
      moved.emplace_back(vertex + step);
      beyond.emplace_back(vertex + step * (1 + 0x1p-52));
    }
    EXPECT_TRUE(intersect(tetrahedron, moved));
    EXPECT_FALSE(intersect(tetrahedron, beyond));
  }
}

TEST(GjkIntersects, DistinguishesNeighbouringDoubles) {
  // The other set is the point (t, t, t), with t one of the doubles next to 1/3; three times a double is
  // never exactly one.
  const double above = std::nextafter(1.0 / 3, 1.0);
  EXPECT_TRUE(intersect(tetrahedron, {Vector3d::Constant(1.0 / 3)}));
  EXPECT_FALSE(intersect(tetrahedron, {Vector3d::Constant(above)}));
  EXPECT_TRUE(intersect(tetrahedron, {Vector3d(0, 0, 0)}));
  EXPECT_FALSE(intersect(tetrahedron, {Vector3d(0, 0, -std::numeric_limits<double>::denorm_min())}));
}

TEST(GjkIntersects, AnswersForManyVerticesAsForThePreparedHulls) {
  // Numbers of vertices that do and do not fill whole blocks; the last vertex, which fills the last block, is
  // extreme.
  Random random(5);
  const Eigen::Isometry3d in_place = Eigen::Isometry3d::Identity();
  int intersecting = 0;
  for (const std::size_t count : {9U, 32U, 33U, 37U, 40U, 100U}) {
    for (int i = 0; i < 50; ++i) {
      Points a, b;
      for (std::size_t k = 0; k < count; ++k) {
        a.push_back(random.in_box({-1, -1, -1}, {1, 1, 1}).normalized());
        b.emplace_back(random.in_box({-1, -1, -1}, {1, 1, 1}).normalized() + Vector3d(1.9, 0, 0));
      }
      a.emplace_back(1.02, 0, 0);
      b.emplace_back(random.uniform(0.9, 1.1), 0, 0);
      const bool expected =
          gjk_intersects(ConvexShape::hull(a), in_place, ConvexShape::hull(b), in_place).intersects;
      ASSERT_EQ(intersect(a, b), expected) << count << ", pair " << i;
      ASSERT_EQ(gjk_distance(a, b).distance == 0, expected) << count << ", pair " << i;
      intersecting += expected ? 1 : 0;
    }
  }
  EXPECT_GT(intersecting, 60);
  EXPECT_LT(intersecting, 240);
}

TEST(GjkIntersects, ProvesGapsThatNoDirectionOfDoublesShows) {
  // Crossing segments ±u and w ± v with integer coordinates and det(u, v, w) = 1. Their gap is 1/|u × v|,
  // about 1e-30, and only directions within 1e-45 of u × v separate them.
  const Vector3d u(-841690050544700, -594843285048260, 1000905404176547);
  const Vector3d v(583736098737179, -180346584185322, 1071208196419212);
  const Vector3d w(284772478851356, 316069082486629, -680505267393819);
  const Points a{-u, u}, b{w - v, w + v};
  const GjkAnswer answer = gjk_intersects(a, b);
  EXPECT_EQ(answer.intersects, hulls_intersect(a, b));
  EXPECT_FALSE(answer.intersects);
  EXPECT_TRUE(std::holds_alternative<SeparatingSimplex>(answer.certificate));
  EXPECT_TRUE(proves(answer, a, b));
  GjkAnswer shorter = answer;
  --std::get<SeparatingSimplex>(shorter.certificate).simplex.size;
  EXPECT_FALSE(proves(shorter, a, b));
}

TEST(GjkIntersects, IsExactInTheWholeRangeOfDoubles) {
  constexpr double huge = std::numeric_limits<double>::max(),
                   tiny = std::numeric_limits<double>::denorm_min();
  const Points wide{{-huge, -huge, 0}, {huge, -huge, 0}, {0, huge, 0}};
  EXPECT_TRUE(intersect(wide, {Vector3d(0, 0, 0)}));
  EXPECT_FALSE(intersect(wide, {Vector3d(0, 0, tiny)}));
  EXPECT_TRUE(intersect(wide, {Vector3d(0, 0, -tiny), Vector3d(0, 0, tiny)}));
}

TEST(GjkCertificate, IsRefusedIfItProvesNothing) {
  const Points far{{5, 5, 5}, {6, 5, 5}}, inside{{0.1, 0.1, 0.1}};
  const GjkAnswer apart = gjk_intersects(tetrahedron, far), together = gjk_intersects(tetrahedron, inside);
  ASSERT_TRUE(proves(apart, tetrahedron, far));
  ASSERT_TRUE(proves(together, tetrahedron, inside));
  EXPECT_FALSE(proves({true, apart.certificate}, tetrahedron, far));
  EXPECT_FALSE(proves({false, together.certificate}, tetrahedron, inside));
  EXPECT_FALSE(proves(apart, tetrahedron, inside));
  EXPECT_FALSE(proves(together, tetrahedron, far));
  EXPECT_FALSE(proves(apart, far, tetrahedron));
  EXPECT_FALSE(proves({false, SeparatingDirection{{0, 0, 0}}}, tetrahedron, far));
  EXPECT_FALSE(proves({false, SeparatingDirection{{infinity, 0, 0}}}, tetrahedron, far));
  // Touching sets are not separated.
  EXPECT_FALSE(proves({false, SeparatingDirection{{1, 0, 0}}}, tetrahedron, {{{1, 0, 0}}}));
  EXPECT_TRUE(proves({false, SeparatingDirection{{1, 1, 1}}}, tetrahedron, far));
  // Points that are not vertices, no points, too few points, and all that are needed.
  const auto around = [&](const Points& points) {
    Simplex simplex;
    for (const Vector3d& point : points)
      simplex.pairs[simplex.size++] = {point, inside.front()};
    return GjkAnswer{true, SimplexAroundOrigin{simplex}};
  };
  const auto& [p, q, r, s] = std::tie(tetrahedron[0], tetrahedron[1], tetrahedron[2], tetrahedron[3]);
  EXPECT_FALSE(proves(around({inside.front()}), tetrahedron, inside));
  EXPECT_FALSE(proves(around({{0, 0, NAN}}), tetrahedron, inside));
  EXPECT_FALSE(proves(around({}), tetrahedron, inside));
  EXPECT_FALSE(proves(around({p, q, r}), tetrahedron, inside));
  EXPECT_TRUE(proves(around({p, q, r, s}), tetrahedron, inside));
  EXPECT_FALSE(proves(apart, {}, far));
  EXPECT_FALSE(proves(apart, tetrahedron, {}));
}

TEST(GjkIntersects, RefusesWrongInputWithAReasonAsTheDistanceDoes) {
  const auto expect_refused = [](const Points& a, const Points& b, const std::string& reason) {
    const auto refusal = testing::ThrowsMessage<InputError>(testing::StrEq(reason));
    EXPECT_THAT([&] { gjk_intersects(a, b); }, refusal);
    EXPECT_THAT([&] { gjk_distance(a, b); }, refusal);
  };
  expect_refused({}, tetrahedron, "A has no vertices");
  expect_refused(tetrahedron, {}, "B has no vertices");
  expect_refused(tetrahedron, {{0, 0, 0}, {0, infinity, 0}}, "vertex 1 of B is not finite");
  expect_refused({{0, NAN, 0}}, tetrahedron, "vertex 0 of A is not finite");
}

Points moved(const Vector3d& step) {
  return placed({tetrahedron, {}}, 1, step).a;
}

TEST(ThesisGjk, DecidesOrdinaryPairsAndCallsTouchingHullsDisjoint) {
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, moved({0.1, 0.1, 0.1})), true);
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, moved({2, 0, 0})), false);
  const Points touching = moved({1, 0, 0});
  EXPECT_TRUE(intersect(tetrahedron, touching));
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, touching), false);
  EXPECT_THROW(thesis_gjk_intersects({}, tetrahedron), InputError);
}

TEST(ThesisGjk, ReturnsNothingIfItDoesNotEnd) {
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, moved({0.1, 0.1, 0.1}), 2), std::nullopt);
  // For some pairs the algorithm does not terminate: many more iterations make no difference.
  Random random(3);
  int endless = 0;
  for (const PairClass& pair_class : pair_classes())
    for (int i = 0; i < 2000; ++i) {
      const ShapePair pair = pair_class.make(random);
      if (thesis_gjk_intersects(pair.a, pair.b, 100))
        continue;
      ++endless;
      EXPECT_EQ(thesis_gjk_intersects(pair.a, pair.b, 10000), std::nullopt);
    }
  EXPECT_GT(endless, 0);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
