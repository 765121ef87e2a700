#include "answers/json_text.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace fringe::answers::FRINGE_TEST_FILE {
namespace {

using Json = nlohmann::ordered_json;
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(JsonText, BeginsWithTheVersionOfTheFormatAndKeepsTheOrderOfKeys) {
  EXPECT_EQ(json_text({{"z", 1}, {"a", {{"y", true}, {"b", nullptr}}}}), "{\n"
                                                                         "    \"format\": 1,\n"
                                                                         "    \"z\": 1,\n"
                                                                         "    \"a\": {\n"
                                                                         "        \"y\": true,\n"
                                                                         "        \"b\": null\n"
                                                                         "    }\n"
                                                                         "}");
}

TEST(JsonText, PutsEveryElementOfAnArrayOnItsOwnLine) {
  EXPECT_EQ(json_text({{"matrix", {{1.0, 2.5}, {-3e-12, 0.0}}}}), "{\n"
                                                                  "    \"format\": 1,\n"
                                                                  "    \"matrix\": [\n"
                                                                  "        [\n"
                                                                  "            1.0,\n"
                                                                  "            2.5\n"
                                                                  "        ],\n"
                                                                  "        [\n"
                                                                  "            -3e-12,\n"
                                                                  "            0.0\n"
                                                                  "        ]\n"
                                                                  "    ]\n"
                                                                  "}");
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
