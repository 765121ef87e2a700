#include "integral/facing.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::Random;

/// A triangle whose vertices appear anticlockwise from +z.
const Triangle upward{Vector3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
const Triangle downward{Vector3d{0, 0, 0}, {0, 1, 0}, {1, 0, 0}};

Rectangle plate_at_height(double height) {
  return {{5, 5, height}, {1, 0, 0}, {0, 1, 0}};
}

TEST(SideOfPlane, IsPositiveWhereTheVerticesAreAnticlockwise) {
  const auto& [a, b, c] = upward;
  EXPECT_EQ(side_of_plane(a, b, c, {3, 4, 1}), 1);
  EXPECT_EQ(side_of_plane(a, b, c, {3, 4, -1}), -1);
  EXPECT_EQ(side_of_plane(a, b, c, {3, 4, 0}), 0);
  EXPECT_EQ(side_of_plane(a, c, b, {3, 4, 1}), -1);
}

TEST(SideOfPlane, IsExactForTheSmallestStepFromThePlane) {
  // p lies in the plane x + y + z = 3·2^50 with integer coordinates; the other points are one unit in the
  // last place off it.
  const double k = std::ldexp(1.0, 50);
  const Vector3d a(3 * k, 0, 0), b(0, 3 * k, 0), c(0, 0, 3 * k), p(k, k, k);
  EXPECT_EQ(side_of_plane(a, b, c, p), 0);
  for (int i = 0; i < 3; ++i) {
    Vector3d above = p, below = p;
    above[i] = std::nextafter(k, 2 * k);
    below[i] = std::nextafter(k, 0);
    EXPECT_EQ(side_of_plane(a, b, c, above), 1);
    EXPECT_EQ(side_of_plane(a, b, c, below), -1);
  }
}

TEST(SideOfPlane, IsExactFarFromTheOriginAndForAnySize) {
  constexpr double tiny = std::numeric_limits<double>::denorm_min(), huge = 1e300;
  for (const double size : {tiny, 1e-160, 1.0, 1e160, huge}) {
    const Vector3d a(0, 0, 0), b(size, 0, 0), c(0, size, 0);
    EXPECT_EQ(side_of_plane(a, b, c, {size, size, tiny}), 1) << size;
    EXPECT_EQ(side_of_plane(a, b, c, {size, size, -tiny}), -1) << size;
    EXPECT_EQ(side_of_plane(a, b, c, {size, -size, 0}), 0) << size;
  }
}

TEST(SideOfPlane, ChangesItsSignWithEveryExchangeOfTwoPoints) {
  // The points lie in a plane up to rounding. The side on which they lie is arbitrary, but must be the same
  // for every order of the points.
  Random random(1);
  const Vector3d u(0.3, 0.1, 0.7), v(-0.2, 0.9, 0.4);
  int off_plane = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto point = [&] {
      const double s = random.uniform(-1, 1), t = random.uniform(-1, 1);
      return Vector3d(Vector3d(100, 200, 300) + s * u + t * v);
    };
    const Vector3d a = point(), b = point(), c = point(), p = point();
    const int side = side_of_plane(a, b, c, p);
    off_plane += side != 0;
    EXPECT_EQ(side_of_plane(b, c, a, p), side);
    EXPECT_EQ(side_of_plane(b, a, c, p), -side);
    EXPECT_EQ(side_of_plane(p, b, c, a), -side);
    EXPECT_EQ(side_of_plane(a, p, c, b), -side);
  }
  EXPECT_GT(off_plane, 500);
}

TEST(Sight, IsOutwardWhenSomeOfThePlateLiesInFront) {
  EXPECT_EQ(sight(upward, plate_at_height(1)), Sight::outward);
  EXPECT_EQ(sight(downward, plate_at_height(1)), Sight::none);
  EXPECT_EQ(sight(upward, plate_at_height(-1)), Sight::none);
  EXPECT_EQ(sight(downward, plate_at_height(-1)), Sight::outward);
}

TEST(Sight, OfAPlateInThePlaneGrazes) {
  EXPECT_EQ(sight(upward, plate_at_height(0)), Sight::grazing);
  EXPECT_EQ(sight(downward, plate_at_height(0)), Sight::grazing);
  EXPECT_EQ(sight(upward, {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}}), Sight::grazing);
}

TEST(Sight, OfAPlateAcrossThePlaneIsOutwardFromBothSides) {
  // The plates differ in the corner that lies in front.
  for (const Rectangle& plate :
       {Rectangle{{2, 0, 1}, {1, 0, -2}, {0, 1, 0}}, Rectangle{{2, 0, -1}, {1, 0, 2}, {0, 1, 0}},
        Rectangle{{2, 0, -1}, {0, 1, 0}, {1, 0, 2}}, Rectangle{{2, 0, -3}, {2, 0, 2}, {-2, 0, 2}}}) {
    EXPECT_EQ(sight(upward, plate), Sight::outward);
    EXPECT_EQ(sight(downward, plate), Sight::outward);
  }
}

TEST(Sight, OfATriangleWithoutAreaGrazes) {
  EXPECT_EQ(sight({Vector3d{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, plate_at_height(1)), Sight::grazing);
}

TEST(Sight, OfAConvexBodyHasOneSideOnly) {
  // A point outside a tetrahedron sees at least one face and at most three; a point inside sees none.
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Vector3d a(1, 1, 1), b(-1, -1, 1), c(-1, 1, -1), d(1, -1, -1);
    const std::vector<Triangle> faces{{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}};
    const Vector3d far = random.in_box({2, -3, -3}, {4, 3, 3}),
                   inside = random.in_box({-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2});
    int seeing = 0;
    for (const Triangle& face : faces) {
      seeing += sight(face, {far, {1e-6, 0, 0}, {0, 1e-6, 0}}) == Sight::outward;
      EXPECT_EQ(sight(face, {inside, {1e-6, 0, 0}, {0, 1e-6, 0}}), Sight::none);
    }
    EXPECT_GE(seeing, 1);
    EXPECT_LE(seeing, 3);
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
