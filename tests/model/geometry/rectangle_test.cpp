#include "fringe/rectangle.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "fringe/error.hpp"

namespace fringe {
namespace {

TEST(Rectangle, IsValidWhenTheEdgesAreAtRightAngles) {
  EXPECT_NO_THROW(validate(Rectangle{{1, 2, 3}, {0.1, 0, 0}, {0, 7e3, 0}}));
}

TEST(Rectangle, MayBeOffARightAngleByOnePartInABillion) {
  EXPECT_NO_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {0.9e-9, 1, 0}}));
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {1.1e-9, 1, 0}}), InputError);
}

TEST(Rectangle, MustHaveTwoEdges) {
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}}), InputError);
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}), InputError);
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), InputError);
}

TEST(Rectangle, MustBeFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(validate(Rectangle{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}), InputError);
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {infinity, 0, 0}, {0, 1, 0}}), InputError);
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 1, nan}}), InputError);
  const double largest = std::numeric_limits<double>::max();
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {largest, largest, 0}, {0, 0, 1}}), InputError) << "its length";
}

}  // namespace
}  // namespace fringe
