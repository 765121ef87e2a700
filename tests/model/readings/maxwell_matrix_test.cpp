#include "readings/maxwell_matrix.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/reading.hpp"
#include "readings/asked_error.hpp"
#include "readings/believed_error.hpp"
#include "readings/matrix_readings.hpp"
#include "readings/readings.hpp"
#include "scenes.hpp"

/// Maxwell matrices without floating conductors, the readings by them, the errors that an answer states, and
/// when refinement ends.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;

/// Two conductors, and two that float of which one has a capacitor to the ground.
ChargedBodies four_conductors() {
  ChargedBodies bodies;
  bodies.conductors = {{"a", Role::sensor, {"a"}},
                       {"b", Role::grounded, {"b"}},
                       {"c", Role::floating, {"c"}},
                       {"d", Role::floating, {"d"}}};
  bodies.conductors[3].to_ground = 0.7;
  for (std::size_t k = 0; k < 4; ++k)
    bodies.bodies.push_back({k, 0, plate_at_origin(1, 1), bodies.conductors[k].name, {}});
  return bodies;
}

/// A Maxwell matrix: symmetric, with dominant diagonal.
const MatrixXd four =
    (MatrixXd(4, 4) << 5, -1, -1.5, -0.5, -1, 6, -2, -1, -1.5, -2, 7, -0.3, -0.5, -1, -0.3, 4).finished();

// Floating conductors take the potentials at which their charge is that of their capacitor, −C·V.
TEST(MaxwellMatrices, ReduceToThoseOfWhatDoesNotFloat) {
  const ChargedBodies bodies = four_conductors();
  const MatrixXd all = potentials(four, bodies), charges = four * all;
  ASSERT_EQ(all.rows(), 4);
  ASSERT_EQ(all.cols(), 2);
  EXPECT_LT((all.topRows(2) - MatrixXd::Identity(2, 2)).norm(), 1e-14);
  EXPECT_LT(charges.row(2).norm(), 1e-14);
  EXPECT_LT((charges.row(3) + 0.7 * all.row(3)).norm(), 1e-14);
  EXPECT_LT((without_floating(four, bodies) - charges.topRows(2)).norm(), 1e-14);
  // Each conductor has one member here.
  EXPECT_LT((member_charges(four, four, bodies) - charges.topRows(2)).norm(), 1e-14);
  EXPECT_LT((floating_block(four, bodies) - (MatrixXd(2, 2) << 7, -0.3, -0.3, 4.7).finished()).norm(), 1e-15);
  EXPECT_EQ(named_answer(bodies).conductors, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(named_answer(bodies).floating, (std::vector<std::string>{"c", "d"}));
}

TEST(MaxwellMatrices, GiveReadingsAsDifferences) {
  Scene scene = test::plate_above_sensor();
  scene.objects.push_back(test::object("housing", Cuboid{0.12, 0.12, 0.03}, test::at(0, 0, -0.04)));
  scene.objects[0].target = true;
  const Scene alone = without_targets(scene);
  ASSERT_EQ(alone.objects.size(), 1U);
  EXPECT_EQ(alone.objects[0].name, "housing");
  const MaxwellMatrix all = maxwell(scene, {.rtol = 1e-3}), background = maxwell(alone, {.rtol = 1e-3});
  const std::vector<ReadingAnswer> found = readings_of_matrices(fringe::readings(scene), all, background);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].value.value.value(), all.values(0, 0), 1e-20);
  EXPECT_NEAR(found[0].change.value.value(), all.values(0, 0) - background.values(0, 0), 1e-20);
  EXPECT_GE(found[0].change.error.value(), all.errors(0, 0));
  const ReadingAnswer& direct = all.readings.at(0);
  EXPECT_LE(std::abs(found[0].change.value.value() - direct.change.value.value()),
            found[0].change.error.value() + direct.change.error.value());
}

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

/// Returns what is believed of an error after a refinement of the answer of one conductor without readings.
double next(BelievedError& error, double value, double stated) {
  ChargedBodies bodies;
  bodies.conductors.push_back({"body", Role::grounded, {"body"}});
  MaxwellMatrix answer;
  answer.values = MatrixXd::Constant(1, 1, value);
  answer.errors = MatrixXd::Constant(1, 1, stated);
  return error.next(answer, MatrixXd::Zero(1, 1), {}, bodies);
}

TEST(BelievedErrors, AreTwiceWhatARefinementUsedOfThem) {
  const auto believed = [](std::pair<double, double> first, std::pair<double, double> second) {
    BelievedError error(1);
    EXPECT_EQ(next(error, first.first, first.second), 1);
    return next(error, second.first, second.second);
  };
  EXPECT_NEAR(believed({1, 0.4}, {1.08, 0.2}), 0.8, 1e-12);
  EXPECT_EQ(believed({1, 0.4}, {1.001, 0.2}), 0.25);
  EXPECT_EQ(believed({1, 0.4}, {1.3, 0.2}), 1);
  EXPECT_EQ(believed({1, 0.2}, {1.001, 0.4}), 1);
  // More than the value cannot have been missing.
  EXPECT_NEAR(believed({0.9, 4}, {1, 0.5}), 0.4, 1e-12);
}

TEST(BelievedErrors, CountAsManyRefinementsAsAreRemembered) {
  BelievedError error(2);
  next(error, 1, 0.4);
  EXPECT_EQ(next(error, 1.06, 0.2), 1) << "one refinement is too few";
  EXPECT_NEAR(next(error, 1.061, 0.1), 0.6, 1e-9) << "the first used more";
  EXPECT_EQ(next(error, 1.062, 0.05), 0.25);
}

TEST(AskedErrors, AreRelativeToTheLargerOfChangeAndAPartOfTheValue) {
  EXPECT_EQ(change_scale(1, 0.5), 0.5);
  EXPECT_EQ(change_scale(1, -0.5), 0.5);
  EXPECT_GT(change_scale(1, 0), 0);
  EXPECT_LT(change_scale(1, 0), 0.1);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
