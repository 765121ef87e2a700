#include "answers/answers.hpp"
#include "answers/json_text.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "scenes.hpp"

namespace fringe::answers::FRINGE_TEST_FILE {
namespace {

using Json = nlohmann::ordered_json;

const Plate square{0.1, 0.1};

/// Returns a sensor of 10 cm at the origin and a plate of the same size in front of it.
Scene plate_at(double height) {
  return test::scene_of(test::square(0.1, 0), {test::object("target", square, test::at(0, 0, height))});
}

TEST(CapacitanceAnswer, HasEverySensorWithItsObjects) {
  const Evaluation evaluation = evaluate(plate_at(0.02));
  const SceneCapacitance& answer = evaluation.capacitance;
  const Json described = capacitance_answer(evaluation, {}, 0.5);
  EXPECT_EQ(described["seconds"], 0.5);
  EXPECT_EQ(described["options"]["method"], "exact");
  EXPECT_EQ(described["counts"]["triangles_evaluated"], 2);
  ASSERT_EQ(described["sensors"].size(), 1U);
  EXPECT_EQ(described["sensors"][0]["total"], answer.sensors[0].total);
  EXPECT_EQ(described["sensors"][0]["objects"], Json::array({{{"name", "target"},
                                                              {"capacitance", answer.sensors[0].total},
                                                              {"error", nullptr},
                                                              {"answered_by", "exact"},
                                                              {"bound", 0.0},
                                                              {"skipped", false}}}));
}

TEST(CapacitanceAnswer, IsInfiniteOnContact) {
  const Json sensor = capacitance_answer(evaluate(plate_at(0)), {}, 0)["sensors"][0];
  EXPECT_EQ(sensor["contact"], true);
  EXPECT_TRUE(std::isinf(sensor["total"].get<double>()));
}

TEST(CapacitanceAnswer, DescribesAMaxwellMatrixAsMaxwellAnswerDoes) {
  const EvaluationOptions options{.method = BoundaryElements{}, .rtol = 0.1};
  const Evaluation evaluation = evaluate(plate_at(0.02), options);
  const MaxwellMatrix& matrix = evaluation.matrix.value();
  const Json answer = capacitance_answer(evaluation, options, 0.5);
  const Json alone = maxwell_answer(matrix, 0.1, 0.5);
  for (const char* key : {"seconds", "reached", "unknowns", "conductors", "members", "floating", "maxwell",
                          "charges", "error", "lower_bounds"})
    EXPECT_EQ(answer[key], alone[key]) << key;
  EXPECT_EQ(answer["options"]["method"], "boundary-elements");
  EXPECT_EQ(answer["options"]["rtol"], alone["rtol"]);
  EXPECT_EQ(answer["maxwell"][0][1], matrix.values(0, 1));
  const Json& sensor = answer["sensors"][0];
  EXPECT_EQ(sensor["self"], matrix.values(0, 0));
  EXPECT_EQ(sensor["delta_self"], alone["delta_self"]["front"]["value"]);
  EXPECT_EQ(sensor["delta_self_error"], alone["delta_self"]["front"]["error"]);
  EXPECT_EQ(sensor["objects"][0]["capacitance"], matrix.mutual(0, 1));
  EXPECT_EQ(sensor["objects"][0]["error"], matrix.errors(0, 1));
}

TEST(CapacitanceAnswer, TellsWhatWasAskedForAndWhoAnswered) {
  const EvaluationOptions options{.rtol = 0.1, .entries = Entries::of_sensors};
  Scene in_a_room = plate_at(0.02);
  in_a_room.has_room = true;
  const Json answer = capacitance_answer(evaluate(in_a_room, options), options, 0.5);
  EXPECT_EQ(answer["options"], (Json{{"method", "auto"}, {"rtol", 0.1}, {"entries", true}}));
  EXPECT_EQ(answer["answered_by"], "formula");
  EXPECT_EQ(answer["reached"], false);
  EXPECT_GE(answer["expected_seconds"], 0);
}

TEST(CollisionAnswer, NamesTheObjectsOfEveryPair) {
  Scene scene = plate_at(0);
  scene.objects.push_back(test::object("other", square, test::at(0, 0, 0)));
  EXPECT_EQ(collision_answer(collide(scene), scene)["pairs"],
            Json::array({{{"a", "target"}, {"b", "other"}, {"status", "collision"}}}));
}

TEST(SensingAnswer, IsNullWhereNothingIsInTheCone) {
  const std::vector<DistanceReading> readings{{"eye", SensedPoint{0.1, {1, 2, 3}, "target", 4}},
                                              {"blind", {}}};
  EXPECT_EQ(sensing_answer(readings)["distance_sensors"], Json::array({{{"name", "eye"},
                                                                        {"distance", 0.1},
                                                                        {"point", {1.0, 2.0, 3.0}},
                                                                        {"object", "target"},
                                                                        {"triangle", 4}},
                                                                       {{"name", "blind"},
                                                                        {"distance", nullptr},
                                                                        {"point", nullptr},
                                                                        {"object", nullptr},
                                                                        {"triangle", nullptr}}}));
}

TEST(InfoAnswer, HasNoVolumeOfAnOpenSurface) {
  const Scene scene = plate_at(0);
  const Json object = info_answer(scene_info(scene), scene)["objects"][0];
  EXPECT_EQ(object["volume"], nullptr);
  EXPECT_EQ(object["aabb"]["minimum"], Json({-0.05, -0.05, 0.0}));
}

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(JsonText, BeginsWithTheVersionAndKeepsTheOrderOfKeysWithEveryElementOnItsOwnLine) {
  EXPECT_EQ(json_text({{"z", 1}, {"a", {{"y", true}, {"b", nullptr}, {"row", {1.0, -3e-12}}}}}), R"({
    "format": 1,
    "z": 1,
    "a": {
        "y": true,
        "b": null,
        "row": [
            1.0,
            -3e-12
        ]
    }
})");
}

TEST(JsonText, WritesEmptyArraysAndObjectsOnOneLine) {
  EXPECT_THAT(json_text({{"none", Json::array()}, {"nothing", Json::object()}}),
              testing::AllOf(testing::HasSubstr("\"none\": [],\n"), testing::HasSubstr("\"nothing\": {}\n")));
}

TEST(JsonText, WritesInfinityAsANumber) {
  EXPECT_THAT(
      json_text({{"total", infinity}, {"change", -infinity}}),
      testing::AllOf(testing::HasSubstr("\"total\": 1e999,\n"), testing::HasSubstr("\"change\": -1e999\n")));
}

TEST(JsonText, EscapesKeysAndTexts) {
  EXPECT_THAT(json_text({{"a \"quoted\" key", "a line\nand another"}}),
              testing::HasSubstr(R"("a \"quoted\" key": "a line\nand another")"));
}

TEST(JsonText, DoublesReadBackToTheLastBit) {
  const std::vector<double> numbers{0.1,
                                    1.0 / 3,
                                    8.8541878128e-12,
                                    4.4270939064e-12,
                                    -0.0,
                                    std::numeric_limits<double>::max(),
                                    std::numeric_limits<double>::min(),
                                    std::numeric_limits<double>::denorm_min(),
                                    std::nextafter(1.0, 2.0)};
  EXPECT_EQ(Json::parse(json_text({{"numbers", numbers}}))["numbers"].get<std::vector<double>>(), numbers);
}

}  // namespace
}  // namespace fringe::answers::FRINGE_TEST_FILE
