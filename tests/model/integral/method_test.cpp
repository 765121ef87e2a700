#include "fringe/method.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"

namespace fringe {
namespace {

TEST(Method, IsReadFromItsText) {
  EXPECT_TRUE(std::holds_alternative<Exact>(parse_method("exact")));
  EXPECT_EQ(std::get<Split>(parse_method("split:4")).levels, 4);
  EXPECT_EQ(std::get<Gauss>(parse_method("gauss:16")).points, 16);
}

TEST(Method, TextReadsBackAsTheSameMethod) {
  for (const std::string text : {"exact", "split:0", "split:10", "gauss:1", "gauss:64"})
    EXPECT_EQ(to_string(parse_method(text)), text);
}

class RefusedMethod : public testing::TestWithParam<std::string> {};

TEST_P(RefusedMethod, NamesItselfInTheError) {
  try {
    parse_method(GetParam());
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'" + GetParam() + "'"));
  }
}

INSTANTIATE_TEST_SUITE_P(Texts, RefusedMethod,
                         testing::Values("", "Exact", "exact ", "split", "split:", "split:-1", "split:11",
                                         "split:4.0", "split:4x", "gauss:0", "gauss:65", "gauss: 4",
                                         "reduced:2", "boundary-elements", "split:99999999999999999999"));

}  // namespace
}  // namespace fringe
