#include "scene/automatic.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace fringe::detail {
namespace {

/// A reading of 4 pF of which a hand changes 0.1 pF, with errors of the value and of the change, in pF.
ReadingAnswer answer(const char* method, double error, double error_of_change) {
  return {"front", {4, error}, {3.9, error}, {0.1, error_of_change}, method};
}

TEST(ImprovedReadings, TakeTheChangeThatIsKnownBetterAndKeepTheValue) {
  ReadingAnswer reading = answer("boundary-elements", 0.2, 0.05);
  ReadingAnswer other{"front", {}, {}, {0.12, 0.01}, "reduced"};
  other.derivatives = {{"arm", PoseDerivatives::Ones(), {}}};
  improve(reading, other);
  EXPECT_EQ(*reading.value.value, 4);
  EXPECT_EQ(*reading.change.value, 0.12);
  EXPECT_EQ(*reading.change.error, 0.01);
  EXPECT_EQ(reading.derivatives.size(), 1U);
  EXPECT_EQ(reading.answered_by, "reduced");
}

TEST(ImprovedReadings, HaveABackgroundThatIsTheirValueLessTheirChange) {
  ReadingAnswer reading = answer("boundary-elements", 0.2, 0.05);
  improve(reading, {"front", {}, {}, {0.12, 0.01}, "reduced"});
  EXPECT_DOUBLE_EQ(*reading.background.value, 3.88);
  EXPECT_DOUBLE_EQ(*reading.background.error, 0.21);
}

TEST(ImprovedReadings, TakeTheValueThatIsKnownBetterAndKeepTheChange) {
  ReadingAnswer reading = answer("reduced", 0.2, 0.01);
  improve(reading, answer("boundary-elements", 0.02, 0.05));
  EXPECT_EQ(*reading.value.error, 0.02);
  EXPECT_EQ(*reading.change.error, 0.01);
  EXPECT_EQ(reading.answered_by, "reduced");
}

TEST(ImprovedReadings, StayWhereTheOtherStatesNoSmallerError) {
  ReadingAnswer reading = answer("boundary-elements", 0.2, 0.05);
  for (const ReadingAnswer& other :
       {answer("reduced", 0.3, 0.06), ReadingAnswer{"front", {}, {}, {}, "reduced"},
        ReadingAnswer{"front", {4}, {3.9}, {0.1}, "formula"}})
    improve(reading, other);
  EXPECT_EQ(*reading.value.error, 0.2);
  EXPECT_EQ(*reading.background.value, 3.9);
  EXPECT_EQ(reading.answered_by, "boundary-elements");
}

TEST(ImprovedReadings, KeepTheBackgroundInContact) {
  ReadingAnswer reading = answer("boundary-elements", 0.2, 0.05);
  improve(reading, {"front", {}, {}, {std::numeric_limits<double>::infinity(), 0}, "reduced"});
  EXPECT_EQ(*reading.background.value, 3.9);
}

}  // namespace
}  // namespace fringe::detail
