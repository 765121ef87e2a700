#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"
#include "integral/facing.hpp"
#include "integral/nearest_plate.hpp"
#include "integral/surface_integral.hpp"

/// Which plate is nearest to which part of a triangle, and which triangles face a plate.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::draws;
using test::Random;

/// The result of a division among plates: ∫dA/min_k d_k, its bound and the number of parts.
struct Division {
  double integral;
  double bound;
  std::size_t parts;
};

Division divide(const std::vector<Triangle>& triangles, const std::vector<Rectangle>& plates,
                double tolerance) {
  std::vector<std::size_t> all(plates.size());
  std::iota(all.begin(), all.end(), 0U);
  NearestPlates division(plates);
  for (const Triangle& triangle : triangles)
    division.add(triangle, all);
  division.refine(tolerance);
  const std::vector<std::vector<Triangle>> shares = division.shares();
  Division result{0, division.bound(), 0};
  for (std::size_t k = 0; k < plates.size(); ++k) {
    result.integral += test::total_integral(shares[k], plates[k]);
    result.parts += shares[k].size();
  }
  return result;
}

/// Returns 1 × 1 tiles that together form a rectangle of columns × rows at the given pose.
std::vector<Rectangle> tiles(int columns, int rows, const Eigen::Isometry3d& pose) {
  std::vector<Rectangle> plates;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j)
      plates.push_back({pose * Vector3d(i, j, 0), pose.linear().col(0), pose.linear().col(1)});
  return plates;
}

Rectangle any_plate(Random& random) {
  const Eigen::Isometry3d pose = random.rigid_motion();
  return {pose.translation(), random.uniform(0.1, 1) * pose.linear().col(0),
          random.uniform(0.1, 1) * pose.linear().col(1)};
}

TEST(NearestPlates, OfTilesIsThePlateTheyMakeUp) {
  // A rectangle and the tiles that compose it have the same distance from every point.
  Random random(3);
  for (int i = 0; i < draws(200); ++i) {
    const Eigen::Isometry3d pose = random.rigid_motion();
    const Rectangle whole{pose.translation(), 3 * pose.linear().col(0), 2 * pose.linear().col(1)};
    Triangle triangle = random.triangle_in_box({-2, -2, 0.05}, {5, 4, 1});
    for (Vector3d& vertex : triangle)
      vertex = pose * vertex;
    const double expected = plate_integral(triangle, whole);
    const Division division = divide({triangle}, tiles(3, 2, pose), 1e-12);
    EXPECT_NEAR(division.integral, expected, 1e-13 * expected);
    // The border between two tiles is a plane, so no fragment is refined.
    EXPECT_LT(division.parts, 500U);
  }
}

TEST(NearestPlates, OfOnePlateOnceOrSeveralTimesIsThatPlate) {
  Random random(4);
  for (int i = 0; i < draws(100); ++i) {
    const Rectangle plate = any_plate(random);
    const Triangle triangle = random.triangle_in_box({3, 3, 3}, {4, 4, 4});
    const double expected = plate_integral(triangle, plate);
    const Division once = divide({triangle}, {plate}, 0);
    EXPECT_EQ(once.integral, plate_integrals(std::vector{triangle}, plate)[0]);
    EXPECT_EQ(once.bound, 0);
    EXPECT_EQ(once.parts, 1U);
    EXPECT_NEAR(divide({triangle}, {plate, plate, plate}, 1e-12).integral, expected, 1e-13 * expected);
  }
}

TEST(NearestPlates, OfParallelPlatesIsTheNearerSideOfTheMiddlePlane) {
  // Between plates at z = 0 and z = 2 the distance is min(z, 2 − z). For a vertical strip of width 1 from z =
  // 1/2 to 3/2 the integral is 2·∫dz/z from 1/2 to 1 = 2·ln 2.
  const std::vector<Rectangle> plates{{{-9, -9, 0}, {18, 0, 0}, {0, 18, 0}},
                                      {{-9, -9, 2}, {18, 0, 0}, {0, 18, 0}}};
  const std::vector<Triangle> strip = test::parallelogram({0, 0, 0.5}, {1, 0, 0}, {0, 0, 1});
  const Division division = divide(strip, plates, 1e-12);
  EXPECT_NEAR(division.integral, 2 * std::log(2), 1e-15);
  EXPECT_EQ(division.bound, 0);
}

TEST(NearestPlates, IsInfiniteWhenThePlateThatIsNotNearestToTheCentroidIsTouched) {
  const std::vector<Rectangle> plates{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0.9, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
  // The triangle crosses the first plate at one end and is closer to the second one everywhere else.
  const Triangle triangle{Vector3d{0.5, 0.2, -0.01}, {9, 0.4, 1.1}, {9, 0.6, 1.1}};
  ASSERT_TRUE(std::isinf(plate_integral(triangle, plates[0])));
  EXPECT_TRUE(std::isinf(divide({triangle}, plates, 1e-12).integral));
  const std::vector<PlateFrame> frames{plate_frame(plates[0]), plate_frame(plates[1])};
  const Vector3d centroid = (triangle[0] + triangle[1] + triangle[2]) / 3;
  EXPECT_LT(distance(frames[1], frames[1].axes * (centroid - frames[1].corner)),
            distance(frames[0], frames[0].axes * (centroid - frames[0].corner)));
}

TEST(NearestPlates, OfACornerThatTouchesTwoPlatesIsFinite) {
  // The plates share an edge at right angles; the triangle touches a point of this edge.
  const std::vector<Rectangle> plates{{{0, -1, 0}, {1, 0, 0}, {0, 2, 0}}, {{0, -1, 0}, {0, 0, 1}, {0, 2, 0}}};
  const Triangle triangle{Vector3d{0, 0, 0}, {0.7, 0.1, 0.2}, {0.3, -0.2, 0.9}};
  const Division division = divide({triangle}, plates, 1e-12);
  const Division coarse = divide({triangle}, plates, 1e-3);
  EXPECT_TRUE(std::isfinite(division.integral));
  EXPECT_LE(division.bound, 1e-12 * division.integral);
  EXPECT_LE(coarse.integral, division.integral * (1 + 1e-13));
  EXPECT_LE(division.integral, coarse.integral + coarse.bound + 1e-12 * division.integral);
}

TEST(NearestPlates, LeavesOutNothingWithoutArea) {
  const std::vector<Rectangle> plates = tiles(2, 1, Eigen::Isometry3d::Identity());
  const Division division = divide({{Vector3d{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}, plates, 1e-12);
  EXPECT_EQ(division.integral, 0);
  EXPECT_EQ(division.bound, 0);
}

/// Random plates and a triangle with points nearest to several of them; no plate touches the triangle.
struct Case {
  std::vector<Rectangle> plates;
  Triangle triangle;
};

Case any_case(Random& random, int plates) {
  while (true) {
    Case result;
    for (int k = 0; k < plates; ++k)
      result.plates.push_back(any_plate(random));
    result.triangle = random.triangle_in_box({-2, -2, -2}, {2, 2, 2});
    if (std::isfinite(divide({result.triangle}, result.plates, 1).integral) &&
        divide({result.triangle}, result.plates, 1).parts > 4)
      return result;
  }
}

/// Returns ∫dA/min_k d_k as a sum over the nodes of a method.
double nearest_node_sum(const Triangle& triangle, const std::vector<Rectangle>& plates,
                        const Method& method) {
  return surface_integral(make_surface({triangle}), plates, {method, PlateRule::nearest, FaceRule::all, 0}, 0)
      .value;
}

TEST(NearestPlates, IsWhatFineNodesFind) {
  // The sum over centroids converges quadratically in their spacing, in spite of the kinks: the change from
  // one level to the next is three times the remaining error.
  Random random(5);
  for (int i = 0; i < draws(40); ++i) {
    const auto [plates, triangle] = any_case(random, 2 + i % 4);
    const double coarse = nearest_node_sum(triangle, plates, Split{5}),
                 fine = nearest_node_sum(triangle, plates, Split{6});
    const double found = divide({triangle}, plates, 1e-12).integral;
    EXPECT_NEAR(found, fine, 2 * std::abs(fine - coarse) + 1e-5 * found);
  }
}

// The truths were computed in 25 digits: a triangle is swept by lines parallel to one of its edges. Along a
// line each squared distance is a piecewise quadratic polynomial; between the zeros that end its pieces, and
// those of the differences of any two, the integrand is smooth, and Gauss-Legendre quadrature integrates it.
// Across the lines, quadrature was halved until two orders agreed to 1e-10.
TEST(NearestPlates, OfPlatesAtAnyAngleIsWhatQuadratureOfTheDistanceFinds) {
  struct Case {
    std::vector<Rectangle> plates;
    Triangle triangle;
    double truth;
  };
  const std::vector<Case> cases{
      {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1.25, 0, 0}, {0.75, 0, 1}, {0, 1, 0}}},
       {Vector3d{-0.5, -0.25, 0.5}, {2.0, 0.5, 1.25}, {0.5, 1.5, 0.75}},
       2.8524763962375},
      {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1.25, 0.25, 0.25}, {1, 0, 0}, {0, 0.5, 0}}},
       {Vector3d{-0.25, -0.5, 0.75}, {2.5, 0.25, 0.5}, {1.0, 1.75, 1.0}},
       4.7494145414129},
      {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        {{2, 0, 0.5}, {0, 1, 0}, {0, 0, 1}},
        {{0, 2, 0.25}, {1, 0, 0}, {0, 0, 1}}},
       {Vector3d{0.25, 0.25, 0.75}, {1.75, 0.5, 1.5}, {0.5, 1.75, 1.0}},
       1.5607022446218}};
  constexpr double accuracy = 2e-10;
  for (const auto& [plates, triangle, truth] : cases)
    for (const double tolerance : {1e-12, 1e-4}) {
      const Division division = divide({triangle}, plates, tolerance);
      EXPECT_LE(division.bound, tolerance * truth);
      EXPECT_LE(division.integral, truth + accuracy);
      EXPECT_LE(truth, division.integral + division.bound + accuracy);
    }
}

TEST(NearestPlates, StaysWithinItsBoundAndTheBoundWithinTheTolerance) {
  Random random(6);
  for (int i = 0; i < draws(40); ++i) {
    const auto [plates, triangle] = any_case(random, 2 + i % 5);
    const Division accurate = divide({triangle}, plates, 1e-13);
    EXPECT_LE(accurate.bound, 1e-13 * accurate.integral);
    const double slack = 1e-12 * accurate.integral;
    for (const double tolerance : {1e-1, 1e-3, 1e-6, 1e-9}) {
      const Division division = divide({triangle}, plates, tolerance);
      EXPECT_LE(division.bound, tolerance * accurate.integral);
      EXPECT_LE(division.integral, accurate.integral + slack);
      EXPECT_LE(accurate.integral, division.integral + division.bound + slack);
      EXPECT_LE(division.parts, accurate.parts);
    }
  }
}

TEST(NearestNodes, OfOnePlateAreTheMethods) {
  Random random(9);
  for (int i = 0; i < 30; ++i) {
    const Rectangle plate = any_plate(random);
    const Triangle triangle = random.triangle_in_box({3, 3, 3}, {4, 4, 4});
    for (const int n : {0, 1, 3}) {
      const double split = plate_integral(triangle, plate, Split{n});
      EXPECT_NEAR(nearest_node_sum(triangle, {plate, plate}, Split{n}), split, 1e-13 * split);
      const double gauss = plate_integral(triangle, plate, Gauss{n + 1});
      EXPECT_NEAR(nearest_node_sum(triangle, {plate, plate}, Gauss{n + 1}), gauss, 1e-13 * gauss);
    }
  }
}

/// A triangle whose vertices appear anticlockwise from +z.
const Triangle upward{Vector3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
const Triangle downward{Vector3d{0, 0, 0}, {0, 1, 0}, {1, 0, 0}};

Rectangle plate_at_height(double height) {
  return {{5, 5, height}, {1, 0, 0}, {0, 1, 0}};
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
  // A triangle whose plane crosses the plate is seen from both sides; the plates differ in the corner in
  // front.
  for (const Rectangle& plate :
       {Rectangle{{2, 0, 1}, {1, 0, -2}, {0, 1, 0}}, Rectangle{{2, 0, -1}, {1, 0, 2}, {0, 1, 0}},
        Rectangle{{2, 0, -1}, {0, 1, 0}, {1, 0, 2}}, Rectangle{{2, 0, -3}, {2, 0, 2}, {-2, 0, 2}}}) {
    EXPECT_EQ(sight(upward, plate), Sight::outward);
    EXPECT_EQ(sight(downward, plate), Sight::outward);
  }
}

TEST(Sight, OfAPlateInThePlaneOrATriangleWithoutAreaGrazes) {
  EXPECT_EQ(sight(upward, plate_at_height(0)), Sight::grazing);
  EXPECT_EQ(sight(downward, plate_at_height(0)), Sight::grazing);
  EXPECT_EQ(sight(upward, {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}}), Sight::grazing);
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
