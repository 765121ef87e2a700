#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/capacitance.hpp"
#include "reduced/surrounded.hpp"
#include "scenes.hpp"

/// The readings of a machine with the conductors around its sensors, at rest or once it has moved
/// (model/CORRECTIONS.md, section 8).
namespace fringe::FRINGE_TEST_FILE {
namespace {

using namespace test;

/// Part of the true change by which answers of a rough preparation may be off in these scenes; boundary
/// elements are asked for a third of it.
constexpr double tolerance = 0.15;

/// Two sensors beside each other, 3 mm before a housing, and a hand on a link of its own.
Scene machine(double gap, const ElectricalRole& role = Grounded{}) {
  const auto plate = [](double x) { return Rectangle{{x - 0.03, -0.04, 0}, {0.06, 0, 0}, {0, 0.08, 0}}; };
  Scene scene;
  scene.links = {{"hand", {}, at(0, 0, 0)}, {"body", {}, at(0, 0, 0)}};
  scene.sensors = {sensor("left", {plate(-0.035)}), sensor("right", {plate(0.035)})};
  const Object hand = object("hand", Cuboid{0.05, 0.09, 0.02}, at(0.01, 0.005, gap + 0.01), role);
  scene.objects = {on_link(1, object("housing", Cuboid{0.2, 0.12, 0.05}, at(0, 0, -0.028))),
                   on_link(0, target(hand))};
  scene.readings = {{"self", "left", {"left"}},
                    {"guarded", "left", {"left", "right"}},
                    {"to", "left", {"right"}},
                    {"fro", "right", {"left"}}};
  return scene;
}

const EvaluationOptions by_boundary_elements{.method = BoundaryElements{}, .rtol = 5e-2};

/// Returns the answers of a scene, prepared roughly or for an accuracy.
std::vector<ReadingAnswer> answers(const Scene& scene, std::optional<double> rtol = {}) {
  return Surrounded(scene).answers(rtol);
}

/// Leaves the first reading: boundary elements take long for small changes of the others.
Scene with_one_reading(Scene scene) {
  scene.readings.resize(1);
  return scene;
}

void expect_near_truth(const Scene& scene) {
  const std::vector<ReadingAnswer> truth = evaluate(scene, by_boundary_elements).readings;
  const std::vector<ReadingAnswer> found = answers(scene);
  expect_agreement(found, truth);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double change = truth[k].change.value.value();
    EXPECT_NEAR(found[k].change.value.value(), change, tolerance * std::abs(change)) << found[k].name;
    EXPECT_GE(found[k].change.error.value(), std::abs(found[k].change.value.value() - change))
        << found[k].name;
  }
}

TEST(ArticulatedModel, IsNearBoundaryElementsForEveryKindOfReading) {
  expect_near_truth(machine(0.03));
}

TEST(ArticulatedModel, KnowsFloatingTargetsAndThoseConnectedThroughACapacitance) {
  expect_near_truth(with_one_reading(machine(0.03, Floating{1e-12})));
  // Insulated, it is at the potential that leaves it without charge.
  const auto change = [](const ElectricalRole& role) {
    return answers(machine(0.03, role))[0].change.value.value();
  };
  EXPECT_LT(0, change(Floating{}));
  EXPECT_LT(change(Floating{}), change(Floating{1e-12}));
  EXPECT_LT(change(Floating{1e-12}), change(Grounded{}));
  EXPECT_NEAR(change(Floating{1}), change(Grounded{}), 1e-6 * change(Grounded{}));
}

TEST(ArticulatedModel, KnowsTargetsOfSeveralBodiesAndFloatingMachines) {
  Scene scene = machine(0.03);
  scene.objects.push_back(target(object("arm", Cylinder{0.02, 0.2, 12}, at(0.01, 0.005, 0.14))));
  scene.objects.push_back(object("shield", Plate{0.1, 0.03}, at(0, 0.09, 0.02), Floating{}));
  expect_near_truth(with_one_reading(scene));
}

/// The hand comes near from 8 to 2 cm, in frames.
std::vector<Frame> approach(const Scene& scene) {
  std::vector<Frame> motion;
  for (int k = 0; k < 12; ++k) {
    Frame& frame = motion.emplace_back(Frame{std::to_string(k), {}});
    for (const Link& link : scene.links)
      frame.poses.push_back(link.pose);
    frame.poses[0] = at(0.002 * k, 0, 0.005 * (12 - k));
  }
  return motion;
}

TEST(ArticulatedModel, AnswersAMotionAsItsFrames) {
  const Scene scene = machine(0.02);
  const std::vector<Frame> motion = approach(scene);
  Surrounded live(scene), other(scene);
  std::vector<std::vector<ReadingAnswer>> one_by_one;
  for (const Frame& frame : motion) {
    other.set_poses(frame.poses);
    one_by_one.push_back(other.answers());
  }
  const std::vector<std::vector<ReadingAnswer>> together = live.answers_of(motion, {}, 2);
  // Targets are prepared for all poses, or for those so far.
  for (std::size_t frame = 0; frame < motion.size(); ++frame)
    expect_agreement(one_by_one[frame], together[frame]);
}

TEST(ArticulatedModelAtLength, AnswersAMotionWithTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = machine(0.02);
  Surrounded one(scene), two(scene);
  EXPECT_EQ(changes_and_errors(one.answers_of(approach(scene), 5e-2, 1)),
            changes_and_errors(two.answers_of(approach(scene), 5e-2, 2)));
}

TEST(ArticulatedModel, KnowsDerivativesWhereAnAccuracyIsAskedFor) {
  Scene scene = machine(0.03);
  constexpr double rtol = 5e-2;
  Surrounded live(scene);
  const std::vector<ReadingAnswer> found = live.answers(rtol, true);
  constexpr double step = 1e-3;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> differences(found.size(), 0);
    for (const double sign : {1.0, -1.0}) {
      live.set_pose("hand",
                    Eigen::Isometry3d(Eigen::Translation3d(sign * step * Eigen::Vector3d::Unit(axis))));
      const std::vector<ReadingAnswer>& moved = live.answers(rtol);
      for (std::size_t k = 0; k < found.size(); ++k)
        differences[k] += sign * moved[k].change.value.value() / (2 * step);
    }
    for (std::size_t k = 0; k < found.size(); ++k) {
      const LinkDerivatives &hand = found[k].derivatives[0], &body = found[k].derivatives[1];
      const double largest = hand.change.head<3>().norm();
      EXPECT_NEAR(hand.change[axis], differences[k], 0.02 * largest) << found[k].name << axis;
      // The housing would move away from the sensors: it is prepared by itself.
      EXPECT_TRUE(std::isfinite(body.change[axis]));
      EXPECT_GT(hand.error.value()[axis], 0);
    }
  }
}

TEST(ArticulatedModel, IsReciprocal) {
  const std::vector<ReadingAnswer> found = answers(machine(0.02));
  const double to = found[2].change.value.value(), fro = found[3].change.value.value();
  EXPECT_LT(to, 0);
  EXPECT_NEAR(to, fro, 1e-6 * std::abs(to));
}

TEST(ArticulatedModel, FollowsThePosesOfTargetAndMachine) {
  Surrounded live(machine(0.03));
  const auto expect_as_prepared_anew = [&] { expect_agreement(live.answers(), answers(live.scene())); };
  const double before = live.answers()[0].change.value.value();
  live.set_pose("hand", at(0.01, 0, 0.02));
  const double away = live.answers()[0].change.value.value();
  EXPECT_LT(away, 0.8 * before);
  expect_as_prepared_anew();
  live.set_pose("body", at(0, 0, -0.02));
  EXPECT_GT(live.answers()[0].change.value.value(), away);
  expect_as_prepared_anew();
}

TEST(ArticulatedModel, FollowsAMachineAndTargetsThatMoveAtOnce) {
  // The hand has a second body on a link of its own.
  Scene scene = with_one_reading(machine(0.03));
  scene.links.push_back({"thumb", {}, at(0, 0, 0)});
  scene.objects.push_back(on_link(2, target(object("thumb", Cuboid{0.02, 0.03, 0.02}, at(-0.06, 0, 0.05)))));
  Surrounded live(scene);
  live.answers();
  live.set_pose("body", at(0, 0, -0.02));
  live.set_pose("thumb", at(0.02, 0, -0.03));
  const std::vector<ReadingAnswer> found = live.answers();
  expect_agreement(found, answers(live.scene()));
  // Where the thumb was, it changed less than is stated now.
  live.set_pose("thumb", at(0, 0, 0));
  EXPECT_LT(live.answers()[0].change.value.value(), found[0].change.value.value());
}

TEST(ArticulatedModel, IsInfiniteWhereAGroundedTargetTouchesWhatIsSensedOrDriven) {
  Scene scene = machine(-0.01);
  scene.objects[1].pose = at(-0.035, 0, 0.005);
  const std::vector<ReadingAnswer> touching = answers(scene);
  EXPECT_TRUE(std::isinf(touching[0].change.value.value()));
  EXPECT_TRUE(std::isinf(touching[3].change.value.value()));
  scene.objects[1].role = Floating{};
  EXPECT_FALSE(answers(scene)[0].change.value);
}

/// A sensor of 10 cm × 8 cm before a housing, and a target on a link of its own.
Scene before_a_target(const Shape& shape, double height) {
  Scene scene =
      scene_of(rectangle(0.1, 0.08, 0), {object("housing", Cuboid{0.12, 0.1, 0.04}, at(0, 0, -0.03)),
                                         on_link(0, target(object("target", shape, at(0, 0, height))))});
  scene.links = {{"hand", {}, at(0, 0, 0)}};
  return scene;
}

Estimate change_of(const Scene& scene, std::optional<double> rtol = {}) {
  return answers(scene, rtol).at(0).change;
}

TEST(ArticulatedModel, EstimatesItsErrorBeforeTargetsOfEverySizeOrSaysThatItIsUnknown) {
  // Boundary elements, the field solver and the sensor before its mirror image agree from 3 m on.
  const std::vector<std::pair<double, double>> truths{
      {0.1, 3.6065e-13}, {0.3, 4.29e-13}, {3, 4.295e-13}, {10, 4.295e-13}, {300, 4.295e-13}};
  for (const auto& [side, truth] : truths) {
    SCOPED_TRACE(side);
    const Estimate found = change_of(before_a_target(Plate{side, side}, 0.06));
    // The functions of a wall of 300 m are much larger than the gap.
    EXPECT_EQ(found.error.has_value(), side < 100);
    if (found.error) {
      EXPECT_LE(std::abs(found.value.value() - truth), *found.error);
    }
  }
}

TEST(ArticulatedModel, EstimatesItsErrorBeforeBoxesOfEveryThickness) {
  for (const double thickness : {0.002, 0.02, 0.3}) {
    SCOPED_TRACE(thickness);
    const Scene scene = before_a_target(Cuboid{0.3, 0.3, thickness}, 0.08 + thickness / 2);
    const double truth = evaluate(scene, by_boundary_elements).readings.at(0).change.value.value();
    const Estimate found = change_of(scene), accurate = change_of(scene, 3e-2);
    for (const Estimate& each : {found, accurate})
      EXPECT_LE(std::abs(each.value.value() - truth), each.error.value());
    EXPECT_LT(*accurate.error, 0.06 * truth);
  }
}

TEST(ArticulatedModel, StatesWhatTheFacetsOfRoundBodiesCost) {
  // Method of images: what a grounded sphere at half a radius changes of an equal one, over 4 pi eps radius.
  constexpr double change = 0.2530227382, radius = 0.1;
  const double truth = 4 * std::numbers::pi * vacuum_permittivity * radius * change;
  for (const int segments : {12, 24}) {
    SCOPED_TRACE(segments);
    Scene scene;
    scene.objects = {object("sensed", Sphere{radius, segments}, at(0, 0, 0), Electrode{}),
                     target(object("near", Sphere{radius, segments}, at(0, 0, 2.5 * radius)))};
    scene.readings = {{"self", "sensed", {"sensed"}}};
    for (const std::optional<double> rtol : {std::optional<double>(), std::optional(1e-2)}) {
      const Estimate found = change_of(scene, rtol);
      ASSERT_TRUE(found.error);
      EXPECT_LE(std::abs(*found.value - truth), *found.error);
      EXPECT_LT(*found.error, 12 * std::abs(*found.value - truth) + 0.02 * truth);
    }
  }
}

TEST(ArticulatedModel, DoesNotDependOnTheUnitOfLength) {
  const auto enlarged = [](double by) {
    Scene scene = before_a_target(Cuboid{0.1 * by, 0.1 * by, 0.03 * by}, 0.06 * by);
    scene.sensors[0].plates = {rectangle(0.1 * by, 0.08 * by, 0)};
    scene.objects[0].shape = Cuboid{0.12 * by, 0.1 * by, 0.04 * by};
    scene.objects[0].pose = at(0, 0, -0.03 * by);
    return change_of(scene);
  };
  const Estimate one = enlarged(1);
  // Powers of two round nothing, so that nothing is divided in another way.
  for (const double by : {1.0 / 1024, 1024.0}) {
    const Estimate other = enlarged(by);
    EXPECT_NEAR(*other.value / by, *one.value, 1e-4 * *one.value);
    EXPECT_NEAR(other.error.value() / by, one.error.value(), 1e-2 * one.error.value());
  }
}

/// Expects a hand that touches a sensor in some frames to be answered in the others as if it never had.
void expect_contact_is_told(const Scene& scene, std::optional<double> rtol) {
  Surrounded live(scene), fresh(scene);
  fresh.set_pose("hand", at(0, 0, 0.03));
  const ReadingAnswer apart = fresh.answers()[0];
  const Estimate alone = apart.change, background = apart.background;
  for (const double height : {-0.01, 0.03, -0.005}) {
    live.set_pose("hand", at(0, 0, height));
    const ReadingAnswer found = live.answers(rtol, rtol.has_value())[0];
    if (height > 0) {
      ASSERT_TRUE(found.change.value);
      EXPECT_NEAR(*found.change.value, *alone.value, *found.change.error + *alone.error);
      continue;
    }
    EXPECT_TRUE(found.derivatives.empty());
    // Contact changes nothing of what is read without the target.
    if (found.change.value) {
      EXPECT_NEAR(found.background.value.value(), background.value.value(),
                  *found.background.error + *background.error);
    }
    EXPECT_EQ(found.change.value.has_value(), std::holds_alternative<Grounded>(scene.objects[1].role));
    EXPECT_TRUE(std::isinf(found.change.value.value_or(HUGE_VAL)));
  }
}

TEST(ArticulatedModel, TellsOfContactAndAnswersAllOtherFrames) {
  Scene scene = before_a_target(Cuboid{0.05, 0.09, 0.02}, 0.01);
  expect_contact_is_told(scene, {});
  scene.objects[1].role = Floating{};
  expect_contact_is_told(scene, 0.5);
}

TEST(ArticulatedModel, OfATargetThatIsJoinedToTheMachineMayBeWrongByAsMuchAsItIs) {
  Scene scene = before_a_target(Cuboid{0.05, 0.09, 0.02}, 0);
  scene.objects[1].pose = at(0.06, 0, -0.025);
  for (const std::optional<double> rtol : {std::optional<double>(), std::optional<double>(0.5)}) {
    const Estimate joined = change_of(scene, rtol);
    ASSERT_TRUE(joined.value && joined.error);
    EXPECT_GE(*joined.error, std::abs(*joined.value));
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
