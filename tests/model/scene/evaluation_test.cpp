#include "fringe/evaluation.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>

#include "evaluated.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "reduced/reduced_capacitance.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

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

TEST(Evaluation, ByTheFormulaStatesNoErrorOfAPair) {
  const Evaluation formula = evaluate(plates(), {.method = Formula{}});
  EXPECT_EQ(target(formula).answered_by, "formula");
  EXPECT_EQ(target(formula).error, std::nullopt);
  EXPECT_TRUE(formula.reached);
  EXPECT_THROW(evaluate(plates(), {.method = Formula{}, .rtol = 0.5}), InputError);
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

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
