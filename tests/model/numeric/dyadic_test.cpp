#include "numeric/dyadic.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

constexpr double largest = std::numeric_limits<double>::max(),
                 least = std::numeric_limits<double>::denorm_min();

TEST(Dyadic, KeepsEveryDouble) {
  for (const double value : {0.0, 1.0, -1.0 / 3, 0x1p-60, largest, -largest, least, -least})
    EXPECT_EQ(Dyadic(value).rounded(), value);
}

TEST(Dyadic, AddsSubtractsAndMultipliesWithoutRounding) {
  const Dyadic sum = Dyadic(largest) + Dyadic(least);
  EXPECT_EQ((sum - Dyadic(largest)).rounded(), least);
  EXPECT_TRUE(sum > Dyadic(largest) && sum == Dyadic(least) + Dyadic(largest));
  // With a rounding, (x + y)(x − y) would differ from x² − y².
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Dyadic x(random.uniform(-1, 1)), y(std::ldexp(random.uniform(-1, 1), i - 500));
    ASSERT_TRUE((x + y) * (x - y) == x * x - y * y) << i;
  }
}

TEST(Dyadic, RoundsQuotientsTowardsZero) {
  // The doubles nearest to 1/3 and 2/3 are below them, that to 5/3 is above it.
  EXPECT_EQ(rounded_quotient(Dyadic(1), Dyadic(3)), 1.0 / 3);
  EXPECT_EQ(rounded_quotient(Dyadic(2), Dyadic(3)), 2.0 / 3);
  EXPECT_EQ(rounded_quotient(Dyadic(5), Dyadic(3)), std::nextafter(5.0 / 3, 0.0));
  EXPECT_EQ(rounded_quotient(Dyadic(-5), Dyadic(3)), std::nextafter(-5.0 / 3, 0.0));
  EXPECT_EQ(rounded_quotient(Dyadic(0), Dyadic(3)), 0);
}

TEST(Dyadic, TakesRootsOfQuotientsOfAnyMagnitude) {
  EXPECT_EQ(rounded_root_quotient(Dyadic(9), Dyadic(2)), 1.5);
  EXPECT_EQ(rounded_root_quotient(Dyadic(largest) * Dyadic(largest), Dyadic(1)), largest);
  EXPECT_EQ(rounded_root_quotient(Dyadic(least) * Dyadic(least), Dyadic(1)), least);
  test::Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double square = std::ldexp(random.uniform(0.5, 1), i - 500), divisor = random.uniform(1, 2);
    const double quotient = rounded_root_quotient(Dyadic(square), Dyadic(divisor));
    ASSERT_NEAR(quotient * divisor / std::sqrt(square), 1, 1e-15) << i;
  }
}

TEST(Dyadic, ScalesAVectorToADirection) {
  const Vector<Dyadic> vector(Dyadic(0), Dyadic(3) * Dyadic(largest), -Dyadic(largest));
  EXPECT_TRUE(direction_of(vector).isApprox(Eigen::Vector3d(0, 0.75, -0.25)));
  EXPECT_EQ(direction_of(Vector<Dyadic>::Zero()), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
