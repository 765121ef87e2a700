/// Tests the time that the progress of boundary elements predicts.

#include "progress.hpp"

#include <gtest/gtest.h>

namespace fringe::cli::FRINGE_TEST_FILE {
namespace {

TEST(RemainingSeconds, AreThoseOfSolutionsThatGainAndTakeAsTheLastOne) {
  // Each gains a factor of 4 and takes twice as long: 1 s, 2 s, then 4 s and 8 s.
  EXPECT_DOUBLE_EQ(remaining_seconds({{0.16, 1}, {0.04, 3}}, 0.0026).value(), 12);
  EXPECT_DOUBLE_EQ(remaining_seconds({{0.64, 0.5}, {0.16, 1.5}, {0.04, 3.5}}, 0.02).value(), 4);
}

TEST(RemainingSeconds, AreNotThoseOfSolutionsThatAreFasterThanTheFirst) {
  EXPECT_DOUBLE_EQ(remaining_seconds({{0.16, 5}, {0.04, 6}}, 0.01).value(), 1);
}

TEST(RemainingSeconds, AreUnknownBeforeTwoSolutionsAndWhereNothingIsGained) {
  EXPECT_FALSE(remaining_seconds({{0.16, 1}}, 0.01));
  EXPECT_FALSE(remaining_seconds({{0.16, 1}, {0.155, 2}}, 0.01));
}

}  // namespace
}  // namespace fringe::cli::FRINGE_TEST_FILE
