#include "fringe/method.hpp"

#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

TEST(Method, IsReadFromItsText) {
  EXPECT_TRUE(std::holds_alternative<Exact>(parse_method("exact")));
  EXPECT_EQ(std::get<Split>(parse_method("split:4")).levels, 4);
  EXPECT_EQ(std::get<Gauss>(parse_method("gauss:16")).points, 16);
  EXPECT_TRUE(std::holds_alternative<BoundaryElements>(parse_method("boundary-elements")));
  EXPECT_TRUE(std::holds_alternative<Formula>(parse_method("formula")));
  EXPECT_TRUE(std::holds_alternative<Reduced>(parse_method("reduced")));
  EXPECT_TRUE(std::holds_alternative<Auto>(parse_method("auto")));
}

TEST(Method, IntegratesOverTrianglesOrIsForWholeScenes) {
  for (const Method& method : {Method{Exact{}}, Method{Split{4}}, Method{Gauss{8}}})
    EXPECT_TRUE(is_integral(method)) << to_string(method);
  for (const Method& method :
       {Method{Formula{}}, Method{Reduced{}}, Method{BoundaryElements{}}, Method{Auto{}}})
    EXPECT_FALSE(is_integral(method)) << to_string(method);
}

TEST(Method, TextReadsBackAsTheSameMethod) {
  for (const std::string text : {"exact", "split:0", "split:10", "gauss:1", "gauss:64", "formula", "reduced",
                                 "boundary-elements", "auto"})
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

TEST(Method, OfBeforeIsRefusedWithWhatToWriteNow) {
  for (const auto& [before, now] :
       {std::pair{"recommended", "auto"}, std::pair{"reduced:2", "reduced with rtol"}})
    try {
      parse_method(before);
      FAIL() << before;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(std::string("write ") + now));
    }
}

INSTANTIATE_TEST_SUITE_P(Texts, RefusedMethod,
                         testing::Values("", "Exact", "exact ", "split", "split:", "split:-1", "split:11",
                                         "split:4.0", "split:4x", "gauss:0", "gauss:65", "gauss: 4",
                                         "formula+nearest", "reduced ", "Auto", "boundary-elements:3",
                                         "split:99999999999999999999"));

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
