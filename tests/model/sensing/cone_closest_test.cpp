#include "fringe/distance_sensor.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "geometry.hpp"
#include "sensed_triangles.hpp"
#include "sensing/precise_cone.hpp"

/// Tests what a cone finds by hand, and for every class of triangles by a convex programme in 100 digits.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using namespace test;

/// Returns a cone from the origin along z.
SensingCone upward_cone(double full_angle = pi / 2, double range = 10) {
  return {Vector3d::Zero(), {0, 0, 1}, full_angle, range};
}

/// Relative tolerance: where an edge or a plane meets the cone at a small angle, the widening of the cone's
/// boundary is amplified several times.
constexpr double tolerance = 10 * 0x1p-50;

class ConeClosest : public testing::TestWithParam<ConeMethod> {
 protected:
  static std::optional<VisiblePoint> closest(const std::vector<Triangle>& triangles,
                                             const SensingCone& cone) {
    return cone_closest(triangles, cone, GetParam());
  }

  static void expect_seen(const Triangle& triangle, const SensingCone& cone, const Vector3d& point) {
    const auto answer = closest({triangle}, cone);
    ASSERT_TRUE(answer);
    const double distance = (point - cone.apex).norm();
    EXPECT_NEAR(answer->distance, distance, tolerance * distance);
    EXPECT_LE((answer->point - point).cwiseAbs().maxCoeff(), tolerance * (distance + point.norm()));
    EXPECT_EQ(answer->triangle, 0U);
  }

  static void expect_unseen(const Triangle& triangle, const SensingCone& cone) {
    EXPECT_FALSE(closest({triangle}, cone));
  }
};

INSTANTIATE_TEST_SUITE_P(, ConeClosest, testing::Values(ConeMethod::field_of_view, ConeMethod::cone_equation),
                         [](const auto& info) {
                           return info.param == ConeMethod::field_of_view ? "FieldOfView" : "ConeEquation";
                         });

TEST_P(ConeClosest, FindsThePointInTheFiveCasesOfTheThesis) {
  // Section 4.2: the foot on the plane; the border of the conic section; a side that meets the cone; the foot
  // on a side; a vertex. The plane x + 2z = 6 has its foot at (6/5, 0, 12/5), which is inside the cone of 45°
  // but outside the cone with tan = 1/4. On the latter, x = z/4 gives z = 8/3. The edge x = 2 + z/2 in the
  // plane y = 0 enters the cone x = z at z = 4.
  const SensingCone narrow = upward_cone(2 * std::atan(0.25));
  const Triangle inclined{{{6, -9, 0}, {6, 9, 0}, {-8, 0, 7}}};
  expect_seen({{{-3, -3, 2}, {3, -3, 2}, {0, 3, 2}}}, upward_cone(), {0, 0, 2});
  expect_seen(inclined, upward_cone(), {1.2, 0, 2.4});
  expect_seen(inclined, narrow, {2. / 3, 0, 8. / 3});
  expect_seen({{{2, 0, 0}, {5, 0, 6}, {9, 7, 3}}}, upward_cone(), {4, 0, 4});
  expect_seen({{{-3, 1, 2}, {3, 1, 2}, {0, 4, 2}}}, upward_cone(), {0, 1, 2});
  expect_seen({{{0.5, 1, 2}, {3, 2, 4}, {0, 4, 5}}}, upward_cone(), {0.5, 1, 2});
}

// Axes parallel to the plane and planes that are met behind the apex are classes below.
TEST_P(ConeClosest, AxisInThePlane) {
  expect_seen({{{-9, 0, 3}, {9, 0, 3}, {0, 0, 5}}}, upward_cone(), {0, 0, 3});
  expect_seen({{{1, 0, -5}, {1, 0, 5}, {9, 0, 0}}}, upward_cone(), {1, 0, 1});
}

TEST_P(ConeClosest, RangeEndsAtASphericalCap) {
  // At 40° off the axis and a distance of 10, the height is only 7.66.
  const Vector3d sight(std::sin(40 * pi / 180), 0, std::cos(40 * pi / 180));
  const Vector3d point = 10 * sight;
  const Triangle within{{point * 0.9999, point + Vector3d(5, 0, 5), point + Vector3d(5, 1, 5)}};
  const Triangle beyond{{point * 1.0001, point + Vector3d(5, 0, 5), point + Vector3d(5, 1, 5)}};
  expect_seen(within, upward_cone(), point * 0.9999);
  expect_unseen(beyond, upward_cone());
}

TEST_P(ConeClosest, ApexOnTheTriangleHasDistanceZero) {
  const Triangle triangle{{{1, 2, 3}, {4, -1, 2}, {0, 1, 5}}};
  SensingCone cone = upward_cone();
  // The products of the weights are rounded. The direction of the sensor must not matter.
  for (const Vector3d& weights : {Vector3d(0.1, 0.2, 0.7), Vector3d(0.3, 0.7, 0), Vector3d(1, 0, 0)})
    for (const Vector3d& direction : {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(1, -1, 0.3)}) {
      cone.apex = weights.x() * triangle[0] + weights.y() * triangle[1] + weights.z() * triangle[2];
      cone.direction = direction;
      const auto answer = closest({triangle}, cone);
      ASSERT_TRUE(answer);
      EXPECT_EQ(answer->distance, 0);
      EXPECT_EQ(answer->point, cone.apex);
    }
}

TEST_P(ConeClosest, ApexOnATriangleInACoordinatePlaneHasDistanceZero) {
  // The triangle's z is exactly 0 in the world, but rounded in the frame of a cone that is not aligned with
  // any axis.
  const Triangle triangle{{{-6.3125, 0.125, 0}, {0, -1.375, 0}, {0, 0, 0}}};
  const SensingCone cone{{-0.0625, 0, 0}, {4, 5.8125, -7.25}, 1.34375, 2.875};
  const auto answer = closest({triangle}, cone);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->distance, 0);
}

TEST_P(ConeClosest, ApexNextToTheTriangleHasNot) {
  for (const double gap : {1e-9, 1e-15, 1e-100})
    expect_seen({{{-3, -3, gap}, {3, -3, gap}, {0, 3, gap}}}, upward_cone(), {0, 0, gap});
}

TEST_P(ConeClosest, BoundaryCountsAsInside) {
  // A vertex on the cone, an edge along it and a plane tangent to it, all otherwise outside; in random
  // orientations.
  const Triangle at_vertex{{{1, 0, 1}, {2, 0, 1}, {2, 1, 1}}};
  const Triangle along_side{{{1, 0, 1}, {3, 0, 3}, {3, 0, 1}}};
  const Triangle in_tangent_plane{{{1, -1, 1}, {1, 1, 1}, {3, 0, 3}}};
  Random random(1);
  for (const Triangle& triangle : {at_vertex, along_side, in_tangent_plane}) {
    expect_seen(triangle, upward_cone(), {1, 0, 1});
    for (int i = 0; i < 100; ++i) {
      const Eigen::Isometry3d motion(random.rigid_motion().linear());
      SensingCone cone = upward_cone();
      cone.direction = motion * cone.direction;
      expect_seen({motion * triangle[0], motion * triangle[1], motion * triangle[2]}, cone,
                  motion * Vector3d(1, 0, 1));
    }
  }
  expect_seen({{{0, 0, 0.1 + 0.2}, {0, 1, 1}, {1, 0, 1}}}, upward_cone(pi / 2, 0.3), {0, 0, 0.3});
}

TEST_P(ConeClosest, JustOutsideDoesNotCount) {
  constexpr double off = 1e-14;
  expect_unseen({{{1 + off, 0, 1}, {2, 0, 1}, {2, 1, 1}}}, upward_cone());
  expect_unseen({{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}}}, upward_cone(pi / 2, 1 - off));
}

TEST_P(ConeClosest, HalfSpaceIsACone) {
  const SensingCone cone = upward_cone(pi);
  const Triangle wall{{{2, -5, -5}, {2, 5, -5}, {2, 0, 9}}};
  expect_seen(wall, cone, {2, 0, 0});
  // A floor in the half space's boundary plane, and one below it.
  expect_seen({{{1, -1, 0}, {2, -1, 0}, {1, 1, 0}}}, cone, {1, 0, 0});
  expect_unseen({{{1, -1, -1e-9}, {2, -1, -1e-9}, {1, 1, -1e-9}}}, cone);
}

TEST_P(ConeClosest, LineThroughTheApexIsSeenAtItsNearEnd) {
  expect_seen({{{0.5, 0.25, 1}, {2, 1, 4}, {2, 1, 4}}}, upward_cone(), {0.5, 0.25, 1});
  expect_unseen({{{0.5, 0.25, -1}, {2, 1, -4}, {2, 1, -4}}}, upward_cone());
}

TEST_P(ConeClosest, OfEquallyNearTrianglesTheFirst) {
  const Triangle above{{{-3, -3, 2}, {3, -3, 2}, {0, 3, 2}}}, higher{{{-3, -3, 3}, {3, -3, 3}, {0, 3, 3}}};
  EXPECT_EQ(closest({higher, above, above, higher}, upward_cone())->triangle, 1U);
  EXPECT_FALSE(closest({}, upward_cone()));
}

TEST_P(ConeClosest, WorksAtTheEndsOfTheRangeOfDoubles) {
  const Triangle triangle{{{6, -9, 0}, {6, 9, 0}, {-8, 0, 7}}};
  for (const int exponent : {-1060, -600, 600, 1018}) {
    const auto scaled = [=](const Vector3d& p) { return Vector3d(std::ldexp(1, exponent) * p); };
    const SensingCone cone{Vector3d::Zero(), {0, 0, 1}, 2 * std::atan(0.25), std::ldexp(10, exponent)};
    const auto answer = closest({{scaled(triangle[0]), scaled(triangle[1]), scaled(triangle[2])}}, cone);
    ASSERT_TRUE(answer);
    const double distance = std::hypot(2. / 3, 8. / 3);
    EXPECT_NEAR(std::ldexp(answer->distance, -exponent), distance, exponent < -1022 ? 1e-4 : 1e-15);
  }
}

TEST(SensingCone, SaysWhatIsWrong) {
  const auto refused = [](auto change) {
    SensingCone cone = upward_cone();
    change(cone);
    EXPECT_THROW(cone_closest({}, cone), InputError);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   infinity = std::numeric_limits<double>::infinity();
  refused([](SensingCone& cone) { cone.apex.x() = nan; });
  refused([](SensingCone& cone) { cone.direction.y() = infinity; });
  refused([](SensingCone& cone) { cone.direction.setZero(); });
  for (const double angle : {0.0, -1.0, 3.15, nan})
    refused([=](SensingCone& cone) { cone.full_angle = angle; });
  for (const double range : {0.0, -1.0, infinity, nan})
    refused([=](SensingCone& cone) { cone.range = range; });
  const std::vector<Triangle> triangles{{{{0, 0, 1}, {0, 1, 1}, {nan, 0, 1}}}};
  EXPECT_THROW(cone_closest(triangles, upward_cone()), InputError);
  EXPECT_THROW(SensedSurface{triangles}, InputError);
  EXPECT_THROW(parse_cone_method("cone"), InputError);
}

TEST(PreciseCone, HasSineAndCosineToThirtyDigits) {
  for (const double angle : {1e-300, 1e-10, 0.1, 1.0, 2.0, 3.0, 3.14159, pi}) {
    const detail::PreciseCone cone = detail::precise_cone({0, 0, 3}, angle);
    const Real half = Real(angle) / 2 + Real(detail::boundary_width);
    const auto error = [](detail::DoubleDouble value, const Real& truth) {
      return Real(abs(Real(value.high) + Real(value.low) - truth));
    };
    EXPECT_LE(error(cone.sine, sin(half)), 1e-30 * sin(half));
    EXPECT_LE(error(cone.cosine, cos(half)), Real(1e-31));
  }
}

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
    const Real expected = cone.apex[i] + truth.offset[i];
    expect_close(answer->point[i], expected, truth.distance + abs(expected), 1e-15);
  }
}

class ConeClosestAccuracy : public testing::TestWithParam<SensedClass> {};

TEST_P(ConeClosestAccuracy, AgreesWithTheConvexProgramme) {
  Random random(1);
  int visible = 0, hidden = 0;
  for (int i = 0; i < FRINGE_CASES_PER_CLASS; ++i) {
    const SensedTriangle seen = GetParam().make(random);
    const ProgrammeAnswer truth = solve(seen.triangle, seen.cone, widening);
    SCOPED_TRACE(i);
    ASSERT_NE(truth.visibility, Visibility::undecided);
    expect_agreement(seen, truth, ConeMethod::field_of_view);
    expect_agreement(seen, truth, ConeMethod::cone_equation);
    ++(truth.visibility == Visibility::visible ? visible : hidden);
  }
  EXPECT_GE(visible, FRINGE_CASES_PER_CLASS / 10);
  EXPECT_GE(hidden, FRINGE_CASES_PER_CLASS / 10);
}

INSTANTIATE_TEST_SUITE_P(, ConeClosestAccuracy, testing::ValuesIn(sensed_classes()),
                         [](const auto& info) { return info.param.name; });

TEST(ConeClosestWidening, IsBelowNotice) {
  Random random(2);
  const SensedClass generic = sensed_classes().front();
  for (int i = 0; i < FRINGE_CASES_PER_CLASS; ++i) {
    const auto [triangle, cone] = generic.make(random);
    const ProgrammeAnswer truth = solve(triangle, cone, 0);
    const auto answer = cone_closest(std::span(&triangle, 1), cone);
    ASSERT_EQ(answer.has_value(), truth.visibility == Visibility::visible);
    if (answer)
      expect_close(answer->distance, truth.distance, truth.distance, 1e-12);
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
