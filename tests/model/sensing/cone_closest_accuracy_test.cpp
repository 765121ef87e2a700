#include <span>

#include <gtest/gtest.h>

#include "convex_programme.hpp"
#include "sensed_triangles.hpp"

/// Compares the results for every class of triangles with a convex programme solved in 100 digits.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using test::ProgrammeAnswer;
using test::Real;
using test::SensedTriangle;
using test::Visibility;

/// The documented widening of the cone's boundary, in radians.
constexpr double widening = 0x1p-50;

/// Checks a value with a tolerance relative to the size of the quantities from which it was computed.
void expect_close(double value, const Real& expected, const Real& size, double tolerance) {
  EXPECT_LE(Real(abs(value - expected)), tolerance * size);
}

void expect_agreement(const SensedTriangle& seen, const ProgrammeAnswer& truth, ConeMethod method) {
  const auto& [triangle, cone] = seen;
  const auto answer = cone_closest(std::span(&triangle, 1), cone, method);
  ASSERT_EQ(answer.has_value(), truth.visibility == Visibility::visible);
  if (!answer)
    return;
  EXPECT_EQ(answer->triangle, 0U);
  expect_close(answer->distance, truth.distance, truth.distance, 1e-15);
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    const Real expected = cone.apex[i] + truth.offset[axis];
    expect_close(answer->point[i], expected, truth.distance + abs(expected), 1e-15);
  }
}

class ConeClosestAccuracy : public testing::TestWithParam<test::SensedClass> {};

TEST_P(ConeClosestAccuracy, AgreesWithTheConvexProgramme) {
  test::Random random(1);
  int visible = 0, hidden = 0;
  for (int i = 0; i < FRINGE_CASES_PER_CLASS; ++i) {
    const SensedTriangle seen = GetParam().make(random);
    const ProgrammeAnswer truth = test::solve(seen.triangle, seen.cone, widening);
    SCOPED_TRACE(i);
    ASSERT_NE(truth.visibility, Visibility::undecided);
    expect_agreement(seen, truth, ConeMethod::field_of_view);
    expect_agreement(seen, truth, ConeMethod::cone_equation);
    ++(truth.visibility == Visibility::visible ? visible : hidden);
  }
  EXPECT_GE(visible, FRINGE_CASES_PER_CLASS / 10);
  EXPECT_GE(hidden, FRINGE_CASES_PER_CLASS / 10);
}

INSTANTIATE_TEST_SUITE_P(, ConeClosestAccuracy, testing::ValuesIn(test::sensed_classes()),
                         [](const auto& info) { return info.param.name; });

TEST(ConeClosestWidening, IsBelowNotice) {
  test::Random random(2);
  const test::SensedClass generic = test::sensed_classes().front();
  for (int i = 0; i < FRINGE_CASES_PER_CLASS; ++i) {
    const auto [triangle, cone] = generic.make(random);
    const ProgrammeAnswer truth = test::solve(triangle, cone, 0);
    const auto answer = cone_closest(std::span(&triangle, 1), cone);
    ASSERT_EQ(answer.has_value(), truth.visibility == Visibility::visible);
    if (answer)
      expect_close(answer->distance, truth.distance, truth.distance, 1e-12);
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
