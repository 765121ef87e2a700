#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "collision/convex_shape_data.hpp"
#include "collision/gjk_filter.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "shape_pairs.hpp"
#include "simd/dispatch.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using namespace test;

Isometry3d moved_by(const Vector3d& translation) {
  return Isometry3d(Eigen::Translation3d(translation));
}

/// Returns a random shape of any kind with sizes from 0.2 to 1.
ConvexShape any_primitive(Random& random) {
  const auto length = [&] { return random.uniform(0.2, 1); };
  switch (below(random, 9)) {
  case 0:
    return ConvexShape::cuboid({length(), length(), length()});
  case 1:
    return ConvexShape::cuboid({length(), length(), 0});
  case 2:
    return ConvexShape::ball(length());
  case 3:
    return ConvexShape::cylinder(length(), length());
  case 4:
    return ConvexShape::cone(length(), length());
  case 5: {
    const double inner = length();
    return ConvexShape::arc_piece(inner, inner + length(), length(), random.uniform(1, 170));
  }
  case 6: {
    // A side of zero gives a stadium, two of them a capsule.
    const auto side = [&] { return random.uniform(0, 1) < 0.4 ? 0 : length(); };
    const double x = side(), y = side();
    return ConvexShape::rounded_cuboid({x, y, length()}, length() / 2);
  }
  case 7:
    return ConvexShape::ellipsoid({length(), length(), length()});
  default:
    return ConvexShape::hull(any_shape(random, 60));
  }
}

/// Returns whether two shapes intersect, and checks the certificate.
bool meet(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b, const Isometry3d& pose_b) {
  const GjkAnswer answer = gjk_intersects(a, pose_a, b, pose_b);
  EXPECT_TRUE(proves(answer, a, pose_a, b, pose_b)) << answer.certificate.index();
  EXPECT_EQ(intersect(a, pose_a, b, pose_b), answer.intersects);
  return answer.intersects;
}

/// Checks that no instruction set contradicts the answer in floating point alone.
void expect_no_contradiction(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                             const Isometry3d& pose_b, bool expected) {
  for (const detail::InstructionSet set : detail::available_instruction_sets()) {
    const detail::Verdict verdict = detail::kernels<detail::GjkFilter>(set).decide(
        {&a.data().support, pose_a.data()}, {&b.data().support, pose_b.data()});
    if (verdict == detail::Verdict::undecided)
      continue;
    ASSERT_EQ(verdict == detail::Verdict::intersecting, expected) << detail::name_of(set);
  }
}

// Hulls of vertices are compared with linear programming by collision_stress.
TEST(ConvexShapes, OfEveryKindProveTheirAnswersInAnyPose) {
  Random random(12);
  int meeting = 0;
  constexpr int pairs = draws(4000);
  for (int i = 0; i < pairs; ++i) {
    SCOPED_TRACE(i);
    const ConvexShape a = any_primitive(random), b = any_primitive(random);
    const Isometry3d pose_a = random.rigid_motion();
    const Isometry3d pose_b = random.rigid_motion();
    const GjkAnswer answer = gjk_intersects(a, pose_a, b, pose_b);
    ASSERT_TRUE(proves(answer, a, pose_a, b, pose_b));
    ASSERT_FALSE(std::holds_alternative<HiddenByRounding>(answer.certificate));
    ASSERT_EQ(intersect(a, pose_a, b, pose_b), answer.intersects);
    ASSERT_EQ(intersect(b, pose_b, a, pose_a), answer.intersects);
    expect_no_contradiction(a, pose_a, b, pose_b, answer.intersects);
    meeting += answer.intersects;
  }
  EXPECT_GT(meeting, pairs / 5);
  EXPECT_LT(meeting, pairs * 4 / 5);
}

/// Tests gaps and overlaps of known sizes along z, between shapes whose poles or faces meet there.
TEST(ConvexShapes, WithRoundSurfacesAreDecidedDownToRounding) {
  const std::vector<ConvexShape> shapes{ConvexShape::ball(0.5),
                                        ConvexShape::cylinder(0.3, 1),
                                        ConvexShape::cone(0.4, 1),
                                        ConvexShape::cuboid({1, 2, 1}),
                                        ConvexShape::arc_piece(0, 0.6, 1, 80),
                                        ConvexShape::rounded_cuboid({0.4, 0.6, 0.6}, 0.2),
                                        ConvexShape::rounded_cuboid({0, 0, 0.6}, 0.2),
                                        ConvexShape::ellipsoid({0.3, 0.4, 0.5})};
  Random random(14);
  for (const ConvexShape& a : shapes)
    for (const ConvexShape& b : shapes) {
      const Isometry3d turn = random.rigid_motion();
      for (const double share : {1e-3, 1e-6, 1e-9, 1e-12}) {
        // Both shapes extend half a metre along z; only the cone ends there in a single point.
        EXPECT_FALSE(meet(a, turn, b, turn * moved_by({0, 0, 1 + share}))) << share;
        EXPECT_TRUE(meet(a, turn, b, turn * moved_by({0, 0, 1 - share}))) << share;
      }
    }
}

TEST(ConvexShapes, ThatAreLongAndThinProveTheirAnswers) {
  Random random(19);
  constexpr int pairs = draws(500);
  for (int i = 0; i < pairs; ++i) {
    const double thickness = std::pow(10, random.uniform(-6, -1));
    const ConvexShape needle = ConvexShape::ellipsoid({thickness, 1, thickness}),
                      rod = ConvexShape::rounded_cuboid({0, 0, 2}, thickness);
    const Isometry3d pose_a = moved_by(random.in_box({-1, -1, -1}, {1, 1, 1})) * random.rigid_motion(),
                     pose_b = random.rigid_motion();
    meet(needle, pose_a, rod, pose_b);
    meet(rod, pose_a, needle, pose_b);
    // Crossing at their middles, they meet.
    const Isometry3d turned(Eigen::AngleAxisd(random.uniform(0, 3), Vector3d::UnitX()));
    EXPECT_TRUE(meet(needle, pose_a, rod, pose_a * turned));
  }
}

TEST(ConvexShapes, StateWhenRoundingHidesWhetherTheyIntersect) {
  const ConvexShape ball = ConvexShape::ball(0.5), cylinder = ConvexShape::cylinder(0.25, 1);
  const Isometry3d turn = Random(15).rigid_motion();
  const Isometry3d beside = turn * moved_by({0.6, 0.45, 0});  // 0.75 away, up to the pose's rounding
  EXPECT_TRUE(meet(ball, turn, cylinder, beside));
  const GjkAnswer answer = gjk_intersects(ball, turn, cylinder, beside);
  ASSERT_TRUE(std::holds_alternative<HiddenByRounding>(answer.certificate));
  const auto& certificate = std::get<HiddenByRounding>(answer.certificate);
  EXPECT_LT(certificate.gap, 1e-12);
  EXPECT_LT(certificate.overlap, 1e-12);
  // A certificate that claims tighter bounds than hold is refused.
  GjkAnswer bolder = answer;
  std::get<HiddenByRounding>(bolder.certificate).overlap = -1e-12;
  EXPECT_FALSE(proves(bolder, ball, turn, cylinder, beside));
  bolder = answer;
  std::get<HiddenByRounding>(bolder.certificate).simplex.pairs[0].a.x() += 1;
  EXPECT_FALSE(proves(bolder, ball, turn, cylinder, beside));
}

TEST(ConvexShapes, WithFlatSurfacesAreExactForTheNumbersOfTheirPoses) {
  // The corners of squares rotated by 45 degrees relative to each other meet. The answer must be exact for
  // the rounded matrix.
  const ConvexShape cube = ConvexShape::cuboid({1, 1, 1});
  Isometry3d turned = Isometry3d::Identity();
  turned.rotate(Eigen::AngleAxisd(std::acos(-1) / 4, Vector3d::UnitZ()));
  const double corner = 0.5 + turned.linear()(0, 0) * 0.5 + std::abs(turned.linear()(0, 1)) * 0.5;
  for (const double offset : {std::nextafter(corner, 0.0), corner, std::nextafter(corner, 2.0)}) {
    turned.translation().x() = offset;
    meet(cube, Isometry3d::Identity(), cube, turned);
  }
  // Here a coordinate of the filter's direction is −0.
  EXPECT_TRUE(meet(cube, Isometry3d::Identity(), cube, moved_by({0.5, 0.25, 0})));
  EXPECT_TRUE(meet(cube, Isometry3d::Identity(), cube, moved_by({1, 0.5, 0})));
  EXPECT_FALSE(meet(cube, Isometry3d::Identity(), cube, moved_by({std::nextafter(1.0, 2.0), 0.5, 0})));
  EXPECT_TRUE(meet(cube, moved_by({1e6, 0, 0}), cube, moved_by({1e6 + 1, 0, 0})));
  EXPECT_FALSE(meet(cube, moved_by({1e6, 0, 0}), cube, moved_by({1e6 + 1.0000001, 0, 0})));
}

TEST(ConvexShapes, KeepTheirAnswerInAnyUnitOfLength) {
  for (const int exponent : {-500, -160, -20, 20, 160, 500}) {
    const double unit = std::ldexp(1.0, exponent);
    const ConvexShape ball = ConvexShape::ball(unit), cube = ConvexShape::cuboid({unit, unit, unit});
    for (const double distance : {1.25, 1.75}) {
      const Isometry3d away = moved_by({distance * unit, 0, 0});
      EXPECT_EQ(intersect(ball, Isometry3d::Identity(), cube, away), distance < 1.5) << exponent;
      EXPECT_EQ(intersect(cube, Isometry3d::Identity(), cube, away), distance < 1) << exponent;
    }
  }
}

TEST(DirectionCells, ContainTheSupportPointOfEveryDirection) {
  // The points lie on a sphere, in a flat disc or along a segment, each of them twice. The directions are
  // random or along borders of the direction cells.
  Random random(17);
  for (const Vector3d& extent : {Vector3d(1, 1, 1), Vector3d(1, 1, 0), Vector3d(0, 0, 1)}) {
    Points points;
    for (int i = 0; i < 600; ++i) {
      points.emplace_back(random.in_box({-1, -1, -1}, {1, 1, 1}).normalized().cwiseProduct(extent));
      points.push_back(points.back());
    }
    const ConvexShape hull = ConvexShape::hull(points);
    ASSERT_GT(hull.data().cells.resolution, 1);
    for (int i = 0; i < draws(20000); ++i) {
      Vector3d direction = random.in_box({-1, -1, -1}, {1, 1, 1});
      if (i % 2 == 0)
        for (double& coordinate : direction)
          coordinate = std::round(coordinate * 4) / 4;
      if (direction.isZero())
        continue;
      Vector3d found;
      detail::best_kernels<detail::GjkFilter>().support(hull.data().support, direction.data(), found.data());
      double highest = -std::numeric_limits<double>::infinity();
      for (const Vector3d& point : points)
        highest = std::max(highest, point.dot(direction));
      ASSERT_GE(found.dot(direction), highest - 1e-15) << direction.transpose();
    }
  }
}

TEST(ConvexShapes, OfManyVerticesIntersectWithoutASafeDirection) {
  // An offset of zero or nearly so is no direction to look up in the direction cells.
  Random random(18);
  Points points;
  for (int i = 0; i < 1300; ++i)
    points.push_back(1e-200 * random.in_box({-1, -1, -1}, {1, 1, 1}).normalized());
  const ConvexShape hull = ConvexShape::hull(points), ball = ConvexShape::ball(1e-200);
  EXPECT_TRUE(meet(hull, Isometry3d::Identity(), ball, Isometry3d::Identity()));
  const Isometry3d offset = moved_by({1e-310, 0, 0});
  EXPECT_TRUE(meet(hull, Isometry3d::Identity(), ball, offset));
  EXPECT_EQ(gjk_distance(hull, offset, hull, Isometry3d::Identity()).distance, 0);
}

TEST(ConvexShapes, WithoutExtentIntersectWhatContainsThem) {
  const Isometry3d here = Isometry3d::Identity();
  const ConvexShape point = ConvexShape::hull(Points{{0, 0, 0}}), ball = ConvexShape::ball(1);
  EXPECT_TRUE(meet(point, here, ball, here));
  EXPECT_TRUE(meet(point, here, point, here));
  EXPECT_TRUE(meet(ball, here, ball, here));
  EXPECT_FALSE(meet(point, here, ball, moved_by({0, 1.5, 0})));
  EXPECT_TRUE(meet(ConvexShape::ball(0), here, ConvexShape::cylinder(0, 1), moved_by({0, 0, 0.25})));
}

TEST(ConvexShapes, RefuseWrongInputWithAReason) {
  const auto expect_refused = [](const auto& make, const std::string& reason) {
    EXPECT_THAT(make, testing::ThrowsMessage<InputError>(testing::StrEq(reason)));
  };
  const Points with_nan{{0, 0, 0}, {0, NAN, 0}};
  expect_refused([] { ConvexShape::hull({}); }, "a convex hull needs at least one vertex");
  expect_refused([&] { ConvexShape::hull(with_nan); }, "vertex 1 is not finite");
  Random random(16);
  const ConvexShape many = ConvexShape::hull(any_shape(random, 1000)), cube = ConvexShape::cuboid({1, 1, 1});
  for (const bool turned : {false, true}) {
    Isometry3d nowhere = Isometry3d::Identity();
    (turned ? nowhere.linear()(1, 2) : nowhere.translation().x()) = NAN;
    for (const ConvexShape& shape : {many, cube})
      expect_refused([&] { intersect(shape, nowhere, cube, Isometry3d::Identity()); },
                     "a pose must be finite");
  }
  expect_refused([] { ConvexShape::ball(-1); },
                 "the radius of a ball must be finite and not negative, not -1");
  const Vector3d negative(1, -1, 1), ones(1, 1, 1), flat(1, 0, 1);
  expect_refused([&] { ConvexShape::rounded_cuboid(negative, 1); },
                 "a side of a rounded cuboid must be finite and not negative, not -1");
  expect_refused([&] { ConvexShape::rounded_cuboid(ones, 0); },
                 "the radius of a rounded cuboid must be finite and greater than zero, not 0");
  expect_refused([&] { ConvexShape::ellipsoid(flat); },
                 "a semi-axis of an ellipsoid must be finite and greater than zero, not 0");
  expect_refused([] { ConvexShape::arc_piece(1, 2, 1, 180); },
                 "a convex piece of an arc must span more than 0 and less than 180 degrees, not 180");
  expect_refused([] { ConvexShape::arc_piece(2, 1, 1, 20); },
                 "the inner radius of an arc must not be above the outer one");
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
