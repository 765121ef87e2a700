/// Differences of products, against exact arithmetic.

#include "numeric/compensated.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry.hpp"
#include "numeric/dyadic.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

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

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
