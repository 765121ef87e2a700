#include <cmath>
#include <string>
#include <utility>

#include <gmock/gmock.h>

#include "fringe/capacitance.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/remarks.hpp"
#include "scenes.hpp"

/// Covers and dielectric targets by the triangle integrals, and before a machine that
/// is prepared roughly (model/CORRECTIONS.md, section 9).
namespace fringe::FRINGE_TEST_FILE {
namespace {

using test::at;
using test::object;
using ::testing::HasSubstr;

constexpr const char* cover_name = "front cover";

/// A sensor of 6 cm × 8 cm on a housing, and a target before it.
Scene before_a_hand(double gap, const ElectricalRole& role = Grounded{}) {
  const Object hand = object("hand", Cuboid{0.08, 0.09, 0.02}, at(0.01, 0.005, gap + 0.01), role);
  return test::scene_of(test::rectangle(0.06, 0.08, 0),
                        {object("housing", Cuboid{0.08, 0.1, 0.05}, at(0, 0, -0.035)), test::target(hand)});
}

Object cover(double side_x, double side_y, double thickness, double permittivity) {
  Object result = object(cover_name, Cuboid{side_x, side_y, thickness}, at(0, 0, thickness / 2),
                         Dielectric{permittivity});
  result.target = false;
  result.conductor = "front";
  return result;
}

Scene covered(Scene scene, double thickness, double permittivity) {
  scene.objects.insert(scene.objects.begin(), cover(0.06, 0.08, thickness, permittivity));
  return scene;
}

double change(const Scene& scene, const EvaluationOptions& options) {
  return evaluate(scene, options).readings.at(0).change.value.value();
}

std::string refusal(const Scene& scene, const EvaluationOptions& options) {
  return test::refusal_of([&] { evaluate(scene, options); });
}

const EvaluationOptions by_integral{};
const EvaluationOptions by_formula{.method = Formula{}};
const EvaluationOptions roughly{.method = Reduced{}, .rtol = 0.1};
EvaluationOptions by_boundary_elements(double rtol) {
  return {.method = BoundaryElements{}, .rtol = rtol};
}

TEST(LayerRule, ACoveredPlateIsNearerByItsThicknessTimesOneLessTheInversePermittivity) {
  Scene moved = before_a_hand(0.02);
  moved.sensors[0].plates[0].corner.z() = 0.003 * (1 - 1 / 4.0);
  EXPECT_NEAR(change(covered(before_a_hand(0.02), 0.003, 4), by_integral), change(moved, by_integral),
              1e-12 * change(moved, by_integral));
}

TEST(LayerRule, AReadingUnderACoverIsWithinItsErrorOfBoundaryElements) {
  for (const auto& [gap, thickness] : {std::pair{0.012, 0.004}, std::pair{0.06, 0.008}}) {
    const Scene scene = covered(before_a_hand(gap), thickness, 4);
    const double truth = change(scene, by_boundary_elements(5e-2));
    const Evaluation answer = evaluate(scene, roughly);
    const Estimate found = answer.readings.at(0).change;
    EXPECT_LT(std::abs(*found.value - truth), 0.12 * truth) << gap;
    EXPECT_LT(std::abs(*found.value - truth), found.error.value()) << gap;
    // The cover is no object of its own.
    EXPECT_EQ(answer.capacitance.sensors.at(0).objects.size(), 2);
    EXPECT_THAT(remarks(scene, roughly, answer), ::testing::Contains(HasSubstr("layer rule")));
  }
}

TEST(LayerRule, GivesAutoMoreThanARoughPreparationWhereBoundaryElementsDoNotAnswer) {
  // Boundary elements have no derivatives beside dielectric bodies.
  const Scene scene = covered(before_a_hand(0.03), 0.002, 3);
  const Evaluation answer = evaluate(scene, {.rtol = 3e-2, .derivatives = true});
  EXPECT_EQ(answer.answered_by, "reduced");
  const Estimate found = answer.readings.at(0).change;
  EXPECT_NEAR(*found.value, change(scene, by_boundary_elements(3e-2)), found.error.value());
  EXPECT_LT(*found.error, 0.8 * evaluate(scene, roughly).readings.at(0).change.error.value());
}

TEST(LayerRule, ACoverThickerThanTheGapIsRefusedByBothNames) {
  const Scene scene = covered(before_a_hand(0.003), 0.004, 3);
  for (const EvaluationOptions& options :
       {by_integral, by_formula, EvaluationOptions{.method = Auto{}}, by_boundary_elements(0.15)})
    EXPECT_THAT(refusal(scene, options),
                AllOf(HasSubstr(cover_name), HasSubstr("hand"), HasSubstr("thicker than the gap")));
  EXPECT_EQ(refusal(covered(before_a_hand(0.003), 0.003, 3), by_formula), "accepted");
}

TEST(DielectricTargets, TheTruthIsWithinTheStatedErrorBetweenNothingAndAConductor) {
  for (const double permittivity : {2.0, 80.0}) {
    const Scene scene = before_a_hand(0.03, Dielectric{permittivity});
    const Estimate found = evaluate(scene, roughly).readings.at(0).change;
    const double truth = change(scene, by_boundary_elements(0.15));
    EXPECT_LT(std::abs(*found.value - truth), found.error.value()) << permittivity;
    EXPECT_GT(*found.value, 0);
    EXPECT_LT(*found.value, change(before_a_hand(0.03, Floating{}), roughly));
  }
}

TEST(DielectricTargets, BesideAConductorTheyAddToItsChange) {
  Scene scene = before_a_hand(0.03);
  scene.objects.push_back(object("blanket", Cuboid{0.1, 0.1, 0.004}, at(0.01, 0.005, 0.028), Dielectric{2}));
  scene.objects.back().target = true;
  const Estimate found = evaluate(scene, roughly).readings.at(0).change;
  EXPECT_GT(*found.value, change(before_a_hand(0.03), roughly));
  EXPECT_LT(std::abs(*found.value - change(scene, by_boundary_elements(0.15))), found.error.value());
}

TEST(DielectricTargets, OnGroundedBodiesTheyAreEnclosedByGroundedConductors) {
  Scene scene = before_a_hand(0.03, Dielectric{3});
  scene.objects[1].pose = at(0.05, 0, 0);
  scene.objects[1].shape = Cuboid{0.02, 0.02, 0.02};
  scene.objects[0].shape = Cuboid{0.2, 0.1, 0.05};
  const Estimate found = evaluate(scene, roughly).readings.at(0).change;
  ASSERT_TRUE(found.value.has_value());
  EXPECT_GE(*found.error, *found.value);
}

TEST(DielectricTargets, IntegralsKnowNoChangeAndSaySo) {
  const Scene scene = before_a_hand(0.03, Dielectric{3});
  const Evaluation answer = evaluate(scene, by_integral);
  EXPECT_FALSE(answer.readings.at(0).change.value.has_value());
  EXPECT_THAT(remarks(scene, by_integral, answer), ::testing::Contains(HasSubstr("\"hand\": dielectric")));
}

TEST(DielectricMachines, AreRefusedByNameWithTheMethodsThatKnowThem) {
  Scene scene = before_a_hand(0.03);
  scene.objects[0].role = Dielectric{3};
  for (const EvaluationOptions& options : {by_integral, by_formula})
    EXPECT_THAT(refusal(scene, options), AllOf(HasSubstr("\"housing\""), HasSubstr("boundary-elements")));
}

TEST(Remarks, APermittivityBelowOneIsRemarkedOn) {
  EXPECT_THAT(remarks(before_a_hand(0.03, Dielectric{0.5})),
              ::testing::Contains(HasSubstr("permittivity of 0.5 is less than")));
  EXPECT_THAT(remarks(before_a_hand(0.03, Dielectric{1})),
              testing::Not(::testing::Contains(HasSubstr("permittivity"))));
}

// Rows of facets' errors are those of the same panels with and without the target.
TEST(CoveredSensors, BeforeARoundTargetAreAnsweredByBoundaryElements) {
  Scene scene = test::scene_of(
      test::square(0.06, 0), {cover(0.06, 0.06, 0.0015, 3), object("ball", Sphere{0.05, 24}, at(0, 0, 0.2))});
  const ReadingAnswer found = evaluate(scene, {.method = BoundaryElements{}, .rtol = 0.05}).readings.at(0);
  // The field solver finds 2.5847 ± 0.0009 pF and 0.0763 ± 0.0008 pF.
  EXPECT_NEAR(*found.value.value, 2.5847e-12, *found.value.error + 0.0009e-12);
  EXPECT_NEAR(*found.change.value, 0.0763e-12, *found.change.error + 0.0008e-12);
}

TEST(DielectricTargets, OfLessPermittivityThanTheMediumAreAnsweredByBoundaryElementsOnly) {
  Scene scene = before_a_hand(0.03, Dielectric{1});
  scene.medium.relative_permittivity = 3;
  EXPECT_THAT(refusal(scene, by_formula), AllOf(HasSubstr("\"hand\""), HasSubstr("boundary-elements")));
  EXPECT_THAT(refusal(scene, {.method = Reduced{}}),
              HasSubstr("hand\": its permittivity is lower than the medium's"));
  EXPECT_LT(change(scene, {.method = Auto{}, .rtol = 0.05}), 0);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
