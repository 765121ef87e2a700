#include "fringe/evaluation.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scene/expected_seconds.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Returns a body above the middle of a square sensor.
Scene before_sensor(const Shape& shape, double height) {
  return scene_of(square(0.1, 0), {object("target", shape, at(0.01, 0.02, height))});
}

const Scene& plates() {
  static const Scene scene = before_sensor(Plate{0.08, 0.12}, 0.03);
  return scene;
}

const ObjectCapacitance& target(const Evaluation& answer) {
  return answer.capacitance.sensors.at(0).objects.at(0);
}

TEST(Evaluation, ByATriangleIntegralMethodIsTheModels) {
  for (const char* method : {"exact", "split:3", "gauss:4", "exact+nearest", "split:2+nearest+facing"}) {
    const EvaluationOptions options = with_method({}, method);
    const Evaluation answer = evaluate(plates(), options);
    EXPECT_EQ(target(answer).capacitance,
              capacitance(plates(), options).sensors.front().objects.front().capacitance);
    EXPECT_EQ(answer.answered_by, method);
    EXPECT_EQ(target(answer).answered_by, method);
    EXPECT_EQ(target(answer).error, std::nullopt);
    EXPECT_FALSE(answer.matrix);
    EXPECT_TRUE(answer.reached);
  }
}

TEST(Evaluation, ByAMatrixIsItsMutualAndItsError) {
  const auto expect = [](const Evaluation& answer, const MaxwellMatrix& matrix, const char* method) {
    ASSERT_TRUE(answer.matrix);
    EXPECT_EQ(answer.matrix->values, matrix.values);
    EXPECT_EQ(target(answer).capacitance, matrix.mutual(0, 1));
    const SensorCapacitance& sensor = answer.capacitance.sensors.at(0);
    EXPECT_EQ(sensor.total, matrix.mutual(0, 1));
    EXPECT_EQ(sensor.voltage, divider_voltage(plates().sensors[0], sensor.total));
    EXPECT_EQ(target(answer).error, matrix.errors(0, 1));
    EXPECT_EQ(target(answer).answered_by, method);
    EXPECT_EQ(answer.answered_by, method);
    EXPECT_TRUE(answer.reached);
  };
  EvaluationOptions options{.method = BoundaryElements{}, .rtol = 1e-2, .entries = Entries::all};
  expect(evaluate(plates(), options), maxwell(plates(), {.rtol = 1e-2}), "boundary-elements");
  options.method = Reduced{};
  expect(evaluate(plates(), options), reduced_capacitance(plates(), {.rtol = 1e-2}), "reduced");
}

TEST(Evaluation, IsPromisedForValueAndChangeOfEveryReading) {
  for (const Method& method : {Method(Reduced{}), Method(BoundaryElements{}), Method(Auto{})})
    for (const double rtol : {1e-2, 1e-3}) {
      const Evaluation answer = evaluate(plates(), {.method = method, .rtol = rtol});
      ASSERT_EQ(answer.readings.size(), 1);
      EXPECT_TRUE(answer.reached);
      const auto& [name, value, background, change, answered_by, reached, derivatives] =
          answer.readings.front();
      EXPECT_EQ(reached, true);
      EXPECT_LE(value.error.value(), rtol * value.value.value());
      EXPECT_LE(change.error.value(), rtol * change.value.value());
    }
}

TEST(EvaluationOptions, OfAnotherMethodAreRefused) {
  const auto refused = [](const char* method, EvaluationOptions options, const char* reason) {
    EXPECT_THAT([&] { evaluate(plates(), with_method(options, method)); },
                ThrowsMessage<InputError>(HasSubstr(reason)))
        << method;
  };
  for (const char* method : {"formula", "reduced", "boundary-elements", "auto"})
    refused(method, {.tolerance = 1e-3}, "tolerance");
  for (const char* method : {"formula+nearest", "reduced+facing", "boundary-elements+nearest", "auto+facing"})
    refused(method, {}, "belong to exact, split:N and gauss:K");
  for (const char* method : {"exact", "split:2", "gauss:2", "formula"}) {
    refused(method, {.rtol = 1e-2}, "rtol is no option of");
    refused(method, {.max_seconds = 1}, "answers at once");
  }
  for (const char* method : {"exact", "formula"})
    refused(method, {.entries = Entries::of_sensors}, "knows no Maxwell matrix");
  for (const char* method : {"exact", "formula", "boundary-elements"})
    refused(method, {.prepared = "folder"}, "prepares nothing");
  for (const char* method : {"formula", "split:2"})
    refused(method, {.derivatives = true}, "derivatives");
}

TEST(EvaluationOptions, OutOfRangeAreRefused) {
  for (const Method& method :
       {Method{BoundaryElements{}}, Method{Reduced{}}, Method{Formula{}}, Method{Auto{}}})
    for (const double rtol : {0.0, -1.0, 0.6, std::nan("")})
      EXPECT_THAT([&] { evaluate(plates(), {.method = method, .rtol = rtol}); },
                  ThrowsMessage<InputError>(HasSubstr("must be from")));
  EXPECT_THROW(evaluate(plates(), {.tolerance = -1}), InputError);
  EXPECT_THROW(evaluate(plates(), {.method = Auto{}, .max_seconds = 0}), InputError);
}

TEST(EvaluationOptions, HaveOneDefaultErrorAndAMethodThatReachesOneThatIsGiven) {
  EXPECT_EQ(rtol_of({.method = BoundaryElements{}}), 1e-2);
  EXPECT_EQ(rtol_of({.method = Reduced{}}), 1e-2);
  EXPECT_EQ(rtol_of({.rtol = 0.03}), 0.03);
  EXPECT_EQ(method_text({}), "exact");
  EXPECT_EQ(method_text({.rtol = 0.03}), "auto");
  for (const char* text : {"gauss:3+nearest", "exact+nearest+facing", "reduced"})
    EXPECT_EQ(method_text(with_method({}, text)), text);
  EXPECT_EQ(method_text(with_method({}, "split:2+facing+nearest")), "split:2+nearest+facing");
}

TEST(Auto, IsTheCheapestThatStatesTheAccuracy) {
  for (const double rtol : {1e-2, 1e-3, 3e-4, 1e-5}) {
    const Evaluation answer = evaluate(plates(), {.rtol = rtol, .entries = Entries::all});
    // The reduced method states no error below 1e-4.
    if (rtol < 1e-4) {
      EXPECT_EQ(answer.answered_by, "boundary-elements");
    }
    EXPECT_TRUE(answer.reached);
    EXPECT_LE(target(answer).error.value(), rtol * target(answer).capacitance);
    EXPECT_NEAR(target(answer).capacitance, maxwell(plates(), {.rtol = 1e-6}).mutual(0, 1),
                rtol * target(answer).capacitance);
  }
}

TEST(Auto, IsTheFormulaInARoomAndStatesNoError) {
  Scene scene = plates();
  scene.has_room = true;
  const Evaluation answer = evaluate(scene, {.method = Auto{}});
  EXPECT_EQ(answer.answered_by, "formula");
  EXPECT_EQ(target(answer).capacitance, target(evaluate(scene, {.method = Formula{}})).capacitance);
  EXPECT_EQ(target(answer).error, std::nullopt);
  EXPECT_FALSE(answer.matrix);
  EXPECT_FALSE(answer.reached);
}

TEST(Auto, OnContactIsCertainlyInfinite) {
  const Evaluation answer = evaluate(before_sensor(Plate{0.1, 0.1}, 0), {.method = Auto{}});
  EXPECT_EQ(answer.answered_by, "formula");
  EXPECT_TRUE(std::isinf(target(answer).capacitance));
  EXPECT_EQ(target(answer).error, 0);
  EXPECT_TRUE(answer.reached);
}

TEST(Auto, AnswersForADielectricBall) {
  Scene scene = before_sensor(Sphere{0.05, 24}, 0.1);
  scene.objects[0].role = Dielectric{3};
  const Evaluation answer = evaluate(scene, {.rtol = 0.1});
  EXPECT_EQ(answer.answered_by, "boundary-elements");
  const Estimate change = answer.readings.at(0).change;
  EXPECT_LT(change.error.value(), 0.1 * change.value.value());
}

TEST(ExpectedSeconds, OfManyBoxesAreThoseOfTheNearestFew) {
  Scene scene = plates();
  const auto seconds = [&] {
    detail::SceneSize size(scene);
    size.count_unknowns(scene);
    return detail::expected_seconds(BoundaryElements{}, size, {.rtol = 1e-2});
  };
  const double few = seconds();
  for (int k = 0; k < 200; ++k)
    scene.objects.push_back(object("box" + std::to_string(k), Cuboid{0.01, 0.01, 0.01}, at(0, 0, 1.0 + k)));
  EXPECT_GT(seconds(), few);
  EXPECT_LT(seconds(), 60);
}

TEST(ExpectedSeconds, OfAReductionOfBoxesThatTouchAreThoseOfABodyOfTriangles) {
  Scene scene = before_sensor(Cuboid{0.02, 0.02, 0.02}, 0.05);
  const auto seconds = [&](const Method& method) {
    detail::SceneSize size(scene);
    size.count_unknowns(scene);
    return detail::expected_seconds(method, size, {.rtol = 1e-2});
  };
  EXPECT_LT(seconds(Reduced{}), 1);
  scene.objects.push_back(object("upon it", Cuboid{0.02, 0.02, 0.02}, at(0.01, 0.02, 0.07)));
  EXPECT_GT(seconds(Reduced{}), 10 * seconds(BoundaryElements{}));
}

TEST(Auto, AnswersForBodiesInContactOnOneLinkAndOnSeveral) {
  Scene scene = before_sensor(Cuboid{0.02, 0.02, 0.02}, 0.05);
  scene.objects.push_back(object("upon it", Cuboid{0.02, 0.02, 0.02}, at(0.01, 0.02, 0.07)));
  const auto answered = [&] { return evaluate(scene, {.rtol = 0.05, .entries = Entries::of_sensors}); };
  const Evaluation together = answered();
  EXPECT_EQ(together.matrix.value().members.at(1), (std::vector<std::string>{"target", "upon it"}));
  scene.links = {{"hand", {}, at(0, 0, 0)}};
  scene.objects[1].link = 0;
  const Evaluation on_links = answered();
  EXPECT_TRUE(together.reached && on_links.reached);
  EXPECT_NEAR(target(on_links).capacitance, target(together).capacitance,
              0.05 * target(together).capacitance);
}

TEST(Auto, RefusesWhatAllMethodsRefuseWithTheReasons) {
  Scene scene = plates();
  scene.has_room = true;
  scene.objects.front().role = Floating{};
  EXPECT_THAT([&] { evaluate(scene, {.method = Auto{}}); },
              ThrowsMessage<InputError>(testing::AllOf(HasSubstr("room"), HasSubstr("floating"))));
}

TEST(Auto, AnswersForElectrodesWithoutSensors) {
  Scene scene;
  scene.objects = {object("a", Cuboid{0.1, 0.1, 0.1}, at(0, 0, 0), Electrode{}),
                   object("b", Cuboid{0.1, 0.1, 0.1}, at(0, 0, 0.5), Electrode{})};
  const MaxwellMatrix known = maxwell(scene, {.rtol = 1e-2});
  for (const ElectricalRole& role : {ElectricalRole(Electrode{}), ElectricalRole(Grounded{})}) {
    scene.objects[1].role = role;
    const Evaluation answer = evaluate(scene, {.method = Auto{}});
    ASSERT_TRUE(answer.matrix);
    EXPECT_TRUE(answer.reached);
    EXPECT_NEAR(answer.matrix->values(0, 1), known.values(0, 1),
                answer.matrix->errors(0, 1) + known.errors(0, 1));
  }
  scene.objects[1].role = Floating{};
  EXPECT_EQ(evaluate(scene, {.method = Auto{}}).matrix.value().values.size(), 1);
}

TEST(Auto, HasNotReachedWhatItKnowsNothingOf) {
  // Ten micrometres between two hexagons of 14 mm: the reduced method knows nothing of their charges. Their
  // faces alone have 112.7 pF.
  Scene scene;
  const Mesh hexagon{"", 1, triangulate(Cylinder{0.007, 0.001, 6})};
  scene.objects = {object("a", hexagon, at(0, 0, 0), Electrode{}),
                   object("b", hexagon, at(0, 0, 0.00101), Electrode{})};
  const Evaluation answer = evaluate(scene, {.method = Auto{}, .rtol = 0.1});
  ASSERT_TRUE(answer.matrix);
  EXPECT_TRUE(answer.matrix->errors.allFinite());
  EXPECT_NEAR(answer.matrix->values(0, 1), -113.5e-12, answer.matrix->errors(0, 1) + 0.8e-12);
}

TEST(Auto, DoesNotAnswerByTheFormulaWhereThatKnowsNoError) {
  Scene scene = hand_before_housing(0.05);
  scene.objects[1].shape = Plate{10, 10};
  EXPECT_FALSE(evaluate(scene, {.method = Formula{}}).readings.at(0).change.error);
  const Evaluation answer = evaluate(scene, {.rtol = 5e-2});
  EXPECT_TRUE(answer.reached);
  const Estimate change = answer.readings.at(0).change;
  EXPECT_LE(change.error.value(), 5e-2 * change.value.value());
}

TEST(Auto, AnswersAMotionAsItsFrames) {
  LiveScene together(hand_before_housing(0.05)), one_by_one(hand_before_housing(0.05));
  std::vector<Frame> motion;
  for (int k = 0; k < 3; ++k)
    motion.push_back({std::to_string(k), {at(0, 0, 0.06 + 0.01 * k)}});
  const auto answers = together.readings_of(motion, {.rtol = 2e-2});
  for (std::size_t frame = 0; frame < motion.size(); ++frame) {
    one_by_one.set_poses(motion[frame].poses);
    expect_agreement(answers[frame], one_by_one.readings({.rtol = 2e-2}));
    const Estimate change = answers[frame].at(0).change;
    EXPECT_LE(change.error.value(), 2e-2 * change.value.value());
  }
}

TEST(Auto, LeavesTheSceneInItsPosesAfterAMotion) {
  LiveScene live(hand_before_housing(0.05));
  const auto present = live.scene().links.at(0).pose.matrix();
  const std::vector<Frame> motion{{"away", {at(0, 0, 0.07)}}};
  live.readings_of(motion, {.method = Formula{}});
  EXPECT_EQ(live.scene().links.at(0).pose.matrix(), present);
  // Also when a frame cannot be used.
  EXPECT_THROW(live.readings_of({motion[0], {"none", {}}}, {.method = Formula{}}), InputError);
  EXPECT_EQ(live.scene().links.at(0).pose.matrix(), present);
}

TEST(Auto, EndsInTimeWithTheBestAnswerSoFar) {
  const Evaluation answer = evaluate(hand_before_housing(0.05), {.rtol = 1e-6, .max_seconds = 0.3});
  EXPECT_FALSE(answer.reached);
  EXPECT_GT(answer.readings.at(0).change.error.value(), 0);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
