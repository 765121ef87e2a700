#include "measured.hpp"
#include "progress.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace fringe::cli::FRINGE_TEST_FILE {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(Measured, HasTheDigitsThatTheErrorLeaves) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Case {
    double value, error;
    const char* text;
  };
  for (const auto& [value, error, text] :
       {Case{2.491424123, 0.000757, "2.49142 ± 0.00076"}, Case{-3.857, 0.0021, "-3.8570 ± 0.0021"},
        Case{11.514, 4.51, "11.5 ± 4.5"}, Case{1234.56, 17.3, "1235 ± 17"},
        // The error is rounded before its digits are counted.
        Case{1.23456, 0.0996, "1.23 ± 0.10"}, Case{1.23456, 9.96, "1 ± 10"},
        // No digit of a value below a large error is known; of one that is zero within a small error, they
        // are.
        Case{20.297973, 274176794320547.46875, "unknown ± 2.7e+14"}, Case{20.0, unknown, "unknown"},
        Case{20.0, infinity, "unknown"}, Case{infinity, 0, "inf"}, Case{-0.0001, 0.0025, "-0.0001 ± 0.0025"},
        // Small numbers and the smallest errors are powers of ten.
        Case{2.5, 3.21e-11, "2.500000000 ± 3.2e-11"}, Case{2.5, 0, "2.5 ± 0"},
        Case{-1.496412e-5, 5.23e-8, "-1.4964e-05 ± 5.2e-08"}, Case{1e-9, 1.9e-12, "1.0000e-09 ± 1.9e-12"},
        Case{2e-9, 3e-9, "2.0e-09 ± 3.0e-09"}, Case{0.0005, 0.00002, "0.000500 ± 0.000020"}})
    EXPECT_EQ(measured(value, error), text);
  EXPECT_EQ(unmeasured(infinity), "inf");
  EXPECT_EQ(unmeasured(88541878128000032), "8.85419e+16") << "no more than six digits without an error";
}

TEST(RemainingSeconds, AreThoseOfSolutionsThatGainAndTakeAsTheLastOne) {
  // Each gains a factor of 4 and takes twice as long: 1 s, 2 s, then 4 s and 8 s.
  EXPECT_DOUBLE_EQ(remaining_seconds({{0.16, 1}, {0.04, 3}}, 0.0026).value(), 12);
  EXPECT_DOUBLE_EQ(remaining_seconds({{0.64, 0.5}, {0.16, 1.5}, {0.04, 3.5}}, 0.02).value(), 4);
  // The last refinement was faster than the first.
  EXPECT_DOUBLE_EQ(remaining_seconds({{0.16, 5}, {0.04, 6}}, 0.01).value(), 1);
  EXPECT_FALSE(remaining_seconds({{0.16, 1}}, 0.01));
  EXPECT_FALSE(remaining_seconds({{0.16, 1}, {0.155, 2}}, 0.01)) << "nothing is gained";
}

}  // namespace
}  // namespace fringe::cli::FRINGE_TEST_FILE
