#include "fringe/rectangle.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fringe/error.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

TEST(Rectangle, IsValidWhenTheEdgesAreAtRightAngles) {
  EXPECT_NO_THROW(validate(Rectangle{{1, 2, 3}, {0.1, 0, 0}, {0, 7e3, 0}}));
}

TEST(Rectangle, MayBeOffARightAngleByOnePartInABillion) {
  EXPECT_NO_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {0.9e-9, 1, 0}}));
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {1.1e-9, 1, 0}}), InputError);
}

TEST(Rectangle, IsSquaredByTurningBothEdgesByHalf) {
  const double angle = 8e-5;
  const Rectangle drawn{{1, 2, 3}, {0.3, 0, 0}, {-0.2 * std::sin(angle), 0, 0.2 * std::cos(angle)}};
  EXPECT_NEAR(cosine_between_edges(drawn), -angle, 1e-12);
  const Rectangle square = squared(drawn);
  EXPECT_EQ(square.corner, drawn.corner);
  EXPECT_NO_THROW(validate(square));
  EXPECT_LT(std::abs(cosine_between_edges(square)), 1e-15);
  EXPECT_NEAR(square.edge_u.norm(), 0.3, 1e-16);
  EXPECT_NEAR(square.edge_v.norm(), 0.2, 1e-16);
  EXPECT_NEAR(std::atan2(square.edge_u.z(), square.edge_u.x()), angle / 2, 1e-15);
  EXPECT_NEAR(std::atan2(-square.edge_v.x(), square.edge_v.z()), angle / 2, 1e-15);
}

TEST(Rectangle, IsSquaredAtAnySize) {
  for (const double size : {1e-300, 1e-160, 1e30})
    EXPECT_LT(std::abs(cosine_between_edges(squared({{0, 0, 0}, {size, 0, 0}, {5e-5 * size, size, 0}}))),
              1e-15)
        << size;
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
}  // namespace fringe::FRINGE_TEST_FILE
