#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry.hpp"
#include "numeric/compensated.hpp"

/// Double-doubles, vectors of them, and differences of products, against exact arithmetic.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

/// The relative error that the header allows for sums, and several times more for what has several steps.
constexpr double unit = 0x1p-106;

Dyadic exact(DoubleDouble a) {
  return Dyadic(a.high) + Dyadic(a.low);
}

DoubleDouble random_number(test::Random& random) {
  const double high = random.uniform(-1, 1);
  return quick_sum(high, 0x1p-54 * high * random.uniform(-1, 1));
}

/// Expects a number to be an exact one up to a part of another.
void expect_near(DoubleDouble found, const Dyadic& expected, const Dyadic& scale, double tolerance) {
  const Dyadic error = exact(found) - expected, allowed = scale * Dyadic(tolerance);
  EXPECT_TRUE(error * error <= allowed * allowed) << found.high;
}

TEST(DoubleDouble, SumsAndProductsOfDoublesAreExact) {
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double a = random.uniform(-1, 1), b = std::ldexp(random.uniform(-1, 1), i % 100 - 50);
    EXPECT_TRUE(exact(exact_sum(a, b)) == Dyadic(a) + Dyadic(b));
    EXPECT_TRUE(exact(exact_product(a, b)) == Dyadic(a) * Dyadic(b));
  }
}

TEST(DoubleDouble, OperationsAreExactToTheBitsThatTheHeaderPromises) {
  test::Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const DoubleDouble a = random_number(random), b = random_number(random);
    expect_near(a + b, exact(a) + exact(b), exact(a) + exact(b), 3 * unit);
    // The worst cancellation: only the last bits are left.
    const DoubleDouble nearly = -quick_sum(a.high, a.low * (1 + 0x1p-40));
    expect_near(a + nearly, exact(a) + exact(nearly), exact(a) + exact(nearly), 3 * unit);
    expect_near(a * b, exact(a) * exact(b), exact(a) * exact(b), 8 * unit);
    // The quotient q has q·b = a, the root r has r·r = a.
    expect_near(a / b * b, exact(a), exact(a), 20 * unit);
    const DoubleDouble positive = a.high < 0 ? -a : a, root = square_root(positive);
    EXPECT_TRUE(exact(root) * exact(root) - exact(positive) < exact(positive) * Dyadic(0x1p-100));
    EXPECT_TRUE(exact(positive) - exact(root) * exact(root) < exact(positive) * Dyadic(0x1p-100));
    EXPECT_EQ(a < b, exact(a) < exact(b));
  }
  EXPECT_EQ(square_root(DoubleDouble{}).high, 0);
}

TEST(DoubleDouble, VectorsKeepWhatDoublesWouldLose) {
  test::Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = random.in_box({-1, -1, -1}, {1, 1, 1}),
                          q = p + 1e-9 * random.in_box({-1, -1, -1}, {1, 1, 1});
    const PreciseVector difference = exact_difference(p, q);
    EXPECT_TRUE(exact(difference.x) == Dyadic(p.x()) - Dyadic(q.x()));
    const PreciseVector a = exact_difference(p, Eigen::Vector3d::Zero());
    // Two nearly parallel vectors: their product is orthogonal to both.
    const PreciseVector normal = cross(a, a + difference);
    EXPECT_LT(std::abs(dot(normal, a).high), 1e-30);
    const auto [length, direction] = polar(difference);
    EXPECT_NEAR(dot(direction, direction).high - 1, 0, 1e-15);
    EXPECT_NEAR(length.high, (p - q).norm(), 1e-15 * length.high);
    EXPECT_LT((rounded(length * direction) - (p - q)).norm(), 1e-15 * length.high);
  }
  EXPECT_EQ(polar({}).length.high, 0);
}

/// Expects a double to be an exact number up to two units in the last place of it.
void expect_rounded(double found, const Dyadic& exact) {
  const double nearest = exact.rounded();
  EXPECT_LE(std::abs(found - nearest), 2 * std::numeric_limits<double>::epsilon() * std::abs(nearest));
}

TEST(Compensated, DifferencesOfProductsDoNotCancel) {
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double a = random.uniform(0.5, 1), b = random.uniform(0.5, 1), c = random.uniform(0.5, 1);
    // The nearest double to what would make the difference zero.
    const double d = a * b / c;
    expect_rounded(difference_of_products(a, b, c, d), Dyadic(a) * Dyadic(b) - Dyadic(c) * Dyadic(d));
  }
  EXPECT_EQ(difference_of_products(3, 5, 5, 3), 0);
}

TEST(Compensated, ProductsOfNearlyParallelVectorsHaveAllDigits) {
  test::Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d a = random.in_box({-1, -1, -1}, {1, 1, 1}),
                          b = 1e5 * a + 1e-10 * random.in_box({-1, -1, -1}, {1, 1, 1}), product = cross(a, b);
    for (int x = 0; x < 3; ++x) {
      const int y = (x + 1) % 3, z = (x + 2) % 3;
      expect_rounded(product[x], Dyadic(a[y]) * Dyadic(b[z]) - Dyadic(a[z]) * Dyadic(b[y]));
    }
  }
}

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
