#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "fringe/thesis.hpp"
#include "shape_pairs.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using test::Points;
using test::Random;
using test::ShapePair;

const Points tetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

Points moved(const Eigen::Vector3d& step) {
  Points points = tetrahedron;
  for (Eigen::Vector3d& point : points)
    point += step;
  return points;
}

TEST(ThesisGjk, DecidesOrdinaryPairs) {
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, moved({0.1, 0.1, 0.1})), true);
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, moved({2, 0, 0})), false);
}

TEST(ThesisGjk, CallsTouchingHullsDisjoint) {
  const Points touching = moved({1, 0, 0});
  EXPECT_TRUE(gjk_intersects(tetrahedron, touching).intersects);
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, touching), false);
}

TEST(ThesisGjk, ReturnsNothingIfItDoesNotEnd) {
  EXPECT_EQ(thesis_gjk_intersects(tetrahedron, moved({0.1, 0.1, 0.1}), 2), std::nullopt);
  // For some pairs the algorithm does not terminate: many more iterations make no difference.
  Random random(3);
  int endless = 0;
  for (const test::PairClass& pair_class : test::pair_classes())
    for (int i = 0; i < 2000; ++i) {
      const ShapePair pair = pair_class.make(random);
      if (thesis_gjk_intersects(pair.a, pair.b, 100))
        continue;
      ++endless;
      EXPECT_EQ(thesis_gjk_intersects(pair.a, pair.b, 10000), std::nullopt);
    }
  EXPECT_GT(endless, 0);
}

TEST(ThesisGjk, RefusesAnEmptySetOfVertices) {
  EXPECT_THROW(thesis_gjk_intersects({}, tetrahedron), InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
