#include "readings/asked_error.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "readings/believed_error.hpp"
#include "readings/readings.hpp"

/// The errors that an answer states, and when refinement ends.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

TEST(AskedErrors, RefinementIsInVainWhereItHardlyReducesTheExcess) {
  Progress useful, vain;
  double excess = 64;
  for (std::size_t unknowns = 1000; unknowns < 100'000'000; unknowns *= 2) {
    EXPECT_FALSE(useful.is_in_vain(excess, unknowns));
    excess /= 2;
  }
  bool has_ended = false;
  for (std::size_t unknowns = 1000; unknowns < 100'000'000; unknowns *= 2)
    has_ended = has_ended || vain.is_in_vain(64, unknowns);
  EXPECT_TRUE(has_ended);
  Progress beginning;
  EXPECT_FALSE(beginning.is_in_vain(64, 10));
}

/// The answer of one conductor without readings.
MaxwellMatrix answer_of_one(double value, double error) {
  MaxwellMatrix answer;
  answer.values = Eigen::MatrixXd::Constant(1, 1, value);
  answer.errors = Eigen::MatrixXd::Constant(1, 1, error);
  return answer;
}

TEST(BelievedErrors, AreTwiceWhatARefinementUsedOfThem) {
  const auto believed = [](const MaxwellMatrix& first, const MaxwellMatrix& second) {
    ChargedBodies bodies;
    bodies.conductors.push_back({"body", Role::grounded, {"body"}});
    const Eigen::MatrixXd lasting = Eigen::MatrixXd::Zero(1, 1);
    BelievedError error(1);
    EXPECT_EQ(error.next(first, lasting, {}, bodies), 1);
    return error.next(second, lasting, {}, bodies);
  };
  EXPECT_NEAR(believed(answer_of_one(1, 0.4), answer_of_one(1.08, 0.2)), 0.8, 1e-12);
  EXPECT_EQ(believed(answer_of_one(1, 0.4), answer_of_one(1.001, 0.2)), 0.25);
  EXPECT_EQ(believed(answer_of_one(1, 0.4), answer_of_one(1.3, 0.2)), 1);
  EXPECT_EQ(believed(answer_of_one(1, 0.2), answer_of_one(1.001, 0.4)), 1);
  // More than the value cannot have been missing.
  EXPECT_NEAR(believed(answer_of_one(0.9, 4), answer_of_one(1, 0.5)), 0.4, 1e-12);
}

TEST(BelievedErrors, CountAsManyRefinementsAsAreRemembered) {
  ChargedBodies bodies;
  bodies.conductors.push_back({"body", Role::grounded, {"body"}});
  const Eigen::MatrixXd lasting = Eigen::MatrixXd::Zero(1, 1);
  BelievedError error(2);
  std::vector<double> believed;
  for (const auto& [value, stated] :
       std::vector<std::pair<double, double>>{{1, 0.4}, {1.06, 0.2}, {1.061, 0.1}, {1.062, 0.05}})
    believed.push_back(error.next(answer_of_one(value, stated), lasting, {}, bodies));
  EXPECT_EQ(believed[1], 1) << "one refinement is too few";
  EXPECT_NEAR(believed[2], 0.6, 1e-9) << "the first used more";
  EXPECT_EQ(believed[3], 0.25);
}

TEST(AskedErrors, AreRelativeToTheLargerOfChangeAndAPartOfTheValue) {
  EXPECT_EQ(change_scale(1, 0.5), 0.5);
  EXPECT_EQ(change_scale(1, -0.5), 0.5);
  EXPECT_GT(change_scale(1, 0), 0);
  EXPECT_LT(change_scale(1, 0), 0.1);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
