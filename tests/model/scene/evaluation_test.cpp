#include "fringe/evaluation.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/reduced_capacitance.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

Object object_of(const std::string& name, const Shape& shape, const Eigen::Vector3d& place) {
  return {name, std::nullopt, shape, pose_from_axis({0, 0, 1}, 0, place), Grounded{}, true};
}

/// Returns a body above the middle of a square sensor.
Scene before_sensor(const Shape& shape, double height) {
  Scene scene;
  Sensor sensor;
  sensor.name = "sensor";
  sensor.plates = {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}};
  scene.sensors = {sensor};
  scene.objects = {object_of("target", shape, {0.01, 0.02, height})};
  return scene;
}

const Scene& plates() {
  static const Scene scene = before_sensor(Plate{0.08, 0.12}, 0.03);
  return scene;
}

const ObjectCapacitance& target(const Evaluation& answer) {
  return answer.capacitance.sensors.at(0).objects.at(0);
}

TEST(Evaluation, ByATriangleIntegralMethodIsTheModels) {
  for (const char* method : {"exact", "split:3", "gauss:4"}) {
    const Evaluation answer = evaluate(plates(), {.method = parse_method(method)});
    EXPECT_EQ(
        target(answer).capacitance,
        capacitance(plates(), {.method = parse_method(method)}).sensors.front().objects.front().capacitance);
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
    EXPECT_EQ(target(answer).error, matrix.errors(0, 1));
    EXPECT_EQ(target(answer).answered_by, method);
    EXPECT_EQ(answer.answered_by, method);
    EXPECT_TRUE(answer.reached);
  };
  expect(evaluate(plates(), {.method = BoundaryElements{}, .rtol = 1e-2}), maxwell(plates(), {.rtol = 1e-2}),
         "boundary-elements");
  expect(evaluate(plates(), {.method = Reduced{2}}), reduced_capacitance(plates()), "reduced:2");
}

TEST(Evaluation, OfACorrectionNamesWhoAnsweredForEachObject) {
  Scene scene = plates();
  const Evaluation formula = evaluate(scene, {.correction = Correction::formula});
  EXPECT_EQ(target(formula).answered_by, "formula");
  EXPECT_EQ(target(formula).error, std::nullopt);
  const Evaluation reduced = evaluate(scene, {.correction = Correction::recommended});
  EXPECT_EQ(target(reduced).answered_by, "reduced:1");
  EXPECT_LT(target(reduced).error.value(), 0.01 * target(reduced).capacitance);
  scene.has_room = true;
  const Evaluation in_a_room = evaluate(scene, {.correction = Correction::recommended});
  EXPECT_EQ(target(in_a_room).answered_by, "formula");
  EXPECT_EQ(target(in_a_room).error, std::nullopt);
}

TEST(EvaluationOptions, OfAnotherMethodAreRefused) {
  for (const Method& method : {Method{BoundaryElements{}}, Method{Reduced{1}}, Method{Recommended{}}}) {
    const auto refused = [&](EvaluationOptions options, const char* option) {
      options.method = method;
      EXPECT_THAT([&] { evaluate(plates(), options); },
                  ThrowsMessage<InputError>(AllOf(HasSubstr(option), HasSubstr("triangle-integral methods"),
                                                  HasSubstr(to_string(method)))));
    };
    refused({.plates = PlateRule::sum}, "plates");
    refused({.faces = FaceRule::all}, "faces");
    refused({.tolerance = 0}, "tolerance");
    refused({.correction = Correction::none}, "correction");
  }
  for (const char* method : {"exact", "split:2", "gauss:2"})
    EXPECT_THAT([&] { evaluate(plates(), {.method = parse_method(method), .rtol = 1e-2}); },
                ThrowsMessage<InputError>(HasSubstr("rtol is an option of the methods boundary-elements")));
}

TEST(EvaluationOptions, OutOfRangeAreRefused) {
  for (const Method& method : {Method{BoundaryElements{}}, Method{Reduced{1}}, Method{Recommended{}}})
    for (const double rtol : {0.0, -1.0, 0.6, std::nan("")})
      EXPECT_THAT([&] { evaluate(plates(), {.method = method, .rtol = rtol}); },
                  ThrowsMessage<InputError>(HasSubstr("must be from")));
  EXPECT_THROW(evaluate(plates(), {.method = Reduced{4}}), InputError);
  EXPECT_THROW(evaluate(plates(), {.tolerance = -1}), InputError);
}

TEST(EvaluationOptions, HaveTheErrorsOfTheirMethodsAsDefaults) {
  EXPECT_EQ(rtol_of({.method = BoundaryElements{}}), 1e-3);
  EXPECT_EQ(rtol_of({.method = Reduced{1}}), 1e-2);
  EXPECT_EQ(rtol_of({.method = Reduced{3}}), 3e-4);
  EXPECT_EQ(rtol_of({.method = Recommended{}}), 1e-2);
  EXPECT_EQ(rtol_of({.method = Recommended{}, .rtol = 0.03}), 0.03);
}

TEST(RecommendedMethod, IsTheReducedMethodWhereThatIsAccurateEnough) {
  const double truth = maxwell(plates(), {.rtol = 1e-5}).mutual(0, 1);
  const std::vector<std::pair<double, std::string>> methods{
      {1e-2, "reduced:1"}, {1e-3, "reduced:2"}, {3e-4, "reduced:3"}};
  for (const auto& [rtol, method] : methods) {
    const Evaluation answer = evaluate(plates(), {.method = Recommended{}, .rtol = rtol});
    EXPECT_EQ(answer.answered_by, method);
    EXPECT_TRUE(answer.reached);
    EXPECT_LE(target(answer).error.value(), rtol * target(answer).capacitance);
    EXPECT_NEAR(target(answer).capacitance, truth, rtol * truth);
  }
}

TEST(RecommendedMethod, IsBoundaryElementsWhereTheReducedMethodIsNotAccurateEnough) {
  // Smaller than the reduced method can state.
  const Evaluation answer = evaluate(plates(), {.method = Recommended{}, .rtol = 1e-5});
  EXPECT_EQ(answer.answered_by, "boundary-elements");
  EXPECT_EQ(target(answer).answered_by, "boundary-elements");
  EXPECT_TRUE(answer.reached);
  EXPECT_LE(target(answer).error.value(), 1e-5 * target(answer).capacitance);
}

TEST(RecommendedMethod, IsTheFormulaInARoomAndStatesNoError) {
  Scene scene = plates();
  scene.has_room = true;
  const Evaluation answer = evaluate(scene, {.method = Recommended{}});
  EXPECT_EQ(answer.answered_by, "formula");
  EXPECT_EQ(target(answer).capacitance,
            target(evaluate(scene, {.correction = Correction::formula})).capacitance);
  EXPECT_EQ(target(answer).error, std::nullopt);
  EXPECT_FALSE(answer.matrix);
  EXPECT_FALSE(answer.reached);
}

TEST(RecommendedMethod, OnContactIsCertainlyInfinite) {
  const Evaluation answer = evaluate(before_sensor(Plate{0.1, 0.1}, 0), {.method = Recommended{}});
  EXPECT_EQ(answer.answered_by, "formula");
  EXPECT_TRUE(std::isinf(target(answer).capacitance));
  EXPECT_EQ(target(answer).error, 0);
  EXPECT_TRUE(answer.reached);
}

TEST(RecommendedMethod, GoesOnToAllUnknownsWhereNothingElseStatesAnError) {
  // 5,040 triangles, more than the methods that take less than a second may have.
  const Evaluation answer = evaluate(before_sensor(Sphere{0.05, 72}, 0.1), {.method = Recommended{}});
  EXPECT_EQ(answer.answered_by, "boundary-elements");
  EXPECT_LT(target(answer).error.value(), 0.02 * target(answer).capacitance);
}

TEST(RecommendedMethod, AnswersForADielectricBallOfManyTriangles) {
  // Boundary elements need more than the 1,000 unknowns that are tried first, and the formula refuses it.
  Scene scene = before_sensor(Sphere{0.05, 36}, 0.1);
  scene.objects[0].role = Dielectric{3};
  const Evaluation answer = evaluate(scene, {.method = Recommended{}});
  EXPECT_EQ(answer.answered_by, "boundary-elements");
  const Estimate change = answer.readings.at(0).change;
  EXPECT_LT(change.error.value(), 0.05 * change.value.value());
}

TEST(RecommendedMethod, KnowsFloatingConductorsAsTheMatricesDo) {
  Scene scene = plates();
  scene.objects.push_back(object_of("foil", Plate{0.1, 0.1}, {0, 0, 0.06}));
  scene.objects.back().role = Floating{};
  const Evaluation answer = evaluate(scene, {.method = Recommended{}});
  EXPECT_EQ(answer.answered_by, "reduced:1");
  EXPECT_EQ(answer.matrix.value().floating, std::vector<std::string>{"foil"});
  EXPECT_EQ(answer.capacitance.sensors.front().objects.size(), 1);
}

TEST(RecommendedMethod, IsTheReducedMethodForBodiesInContactUnlessTheirLinksMayMoveThemApart) {
  Scene scene = before_sensor(Cuboid{0.02, 0.02, 0.02}, 0.05);
  scene.objects.push_back(object_of("upon it", Cuboid{0.02, 0.02, 0.02}, {0.01, 0.02, 0.07}));
  const auto answered = [&] { return evaluate(scene, {.method = Recommended{}, .rtol = 0.05}); };
  const Evaluation together = answered();
  EXPECT_EQ(together.answered_by, "reduced:1");
  EXPECT_EQ(together.matrix.value().members.at(1), (std::vector<std::string>{"target", "upon it"}));
  // Each pose of the link would take seconds of preparation.
  scene.links = {{"hand", std::nullopt, pose_from_axis({0, 0, 1}, 0, {0, 0, 0})}};
  scene.objects[1].link = 0;
  const Evaluation on_links = answered();
  EXPECT_EQ(on_links.answered_by, "boundary-elements");
  EXPECT_NEAR(target(on_links).capacitance, target(together).capacitance,
              0.05 * target(together).capacitance);
}

TEST(RecommendedMethod, RefusesWhatAllMethodsRefuseWithTheReasons) {
  Scene scene = plates();
  scene.has_room = true;
  scene.objects.front().role = Floating{};
  EXPECT_THAT([&] { evaluate(scene, {.method = Recommended{}}); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("room"), HasSubstr("floating"))));
}

Object electrode(const std::string& name, const Shape& shape, const Eigen::Vector3d& place) {
  Object result = object_of(name, shape, place);
  result.role = Electrode{};
  return result;
}

TEST(RecommendedMethod, AnswersForElectrodesWithoutSensors) {
  Scene scene;
  scene.objects = {electrode("a", Cuboid{0.1, 0.1, 0.1}, {0, 0, 0}),
                   electrode("b", Cuboid{0.1, 0.1, 0.1}, {0, 0, 0.5})};
  const MaxwellMatrix known = maxwell(scene, {.rtol = 1e-2});
  for (const ElectricalRole& role : {ElectricalRole(Electrode{}), ElectricalRole(Grounded{})}) {
    scene.objects[1].role = role;
    const Evaluation answer = evaluate(scene, {.method = Recommended{}});
    ASSERT_TRUE(answer.matrix);
    EXPECT_TRUE(answer.reached);
    EXPECT_NEAR(answer.matrix->values(0, 1), known.values(0, 1),
                answer.matrix->errors(0, 1) + known.errors(0, 1));
  }
  scene.objects[1].role = Floating{};
  EXPECT_EQ(evaluate(scene, {.method = Recommended{}}).matrix.value().values.size(), 1);
}

TEST(RecommendedMethod, GoesOnWhereNothingElseAnswersWithoutSensors) {
  // More triangles than the reduced method prepares, and than boundary elements may have unknowns at first.
  Scene scene;
  scene.objects = {electrode("a", Sphere{0.1, 48}, {0, 0, 0}), electrode("b", Sphere{0.1, 48}, {0, 0, 0.5})};
  EXPECT_TRUE(evaluate(scene, {.method = Recommended{}}).matrix.has_value());
}

TEST(RecommendedMethod, HasNotReachedWhatItKnowsNothingOf) {
  // Ten micrometres between two hexagons of 14 mm: the reduced method knows nothing of their charges. Their
  // faces alone have 112.7 pF.
  Scene scene;
  scene.objects = {electrode("a", Cylinder{0.007, 0.001, 6}, {0, 0, 0}),
                   electrode("b", Cylinder{0.007, 0.001, 6}, {0, 0, 0.00101})};
  const Evaluation answer = evaluate(scene, {.method = Recommended{}, .rtol = 0.1});
  ASSERT_TRUE(answer.matrix);
  EXPECT_TRUE(answer.matrix->errors.allFinite());
  EXPECT_NEAR(answer.matrix->values(0, 1), -113.5e-12, answer.matrix->errors(0, 1) + 0.8e-12);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
