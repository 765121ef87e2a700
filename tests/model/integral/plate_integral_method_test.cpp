#include "fringe/method.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/plate_integral.hpp"
#include "geometry.hpp"

/// Compares the numerical methods with the exact one, and tests the arguments that every method refuses.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Rectangle plate{{0, 0, 0}, {1, 0, 0}, {0, 0.8, 0}};

struct NamedTriangle {
  const char* region;
  Triangle triangle;
};

const std::vector<NamedTriangle> triangles{
    {"I", {Eigen::Vector3d{0.1, 0.1, 0.5}, {0.8, 0.2, 0.7}, {0.3, 0.7, 0.9}}},
    {"II", {Eigen::Vector3d{-0.5, 0.1, 0.2}, {-0.9, 0.3, 0.4}, {-0.4, 0.7, 0.6}}},
    {"III", {Eigen::Vector3d{-0.5, -0.3, 0.2}, {-0.9, -0.2, 0.4}, {-0.4, -0.7, 0.6}}},
};

double relative_error(const Triangle& triangle, const Method& method) {
  const double exact = plate_integral(triangle, plate);
  return std::abs(plate_integral(triangle, plate, method) - exact) / exact;
}

TEST(SplitMethod, WithoutLevelsIsAreaOverTheCentroidsDistance) {
  // The centroid (0.4, 0.3, 0.6) lies in front of the plate.
  const Triangle triangle{Eigen::Vector3d{0.1, 0.1, 0.5}, {0.8, 0.1, 0.4}, {0.3, 0.7, 0.9}};
  EXPECT_DOUBLE_EQ(plate_integral(triangle, plate, Split{0}), twice_area(triangle) / 2 / 0.6);
}

TEST(SplitMethod, TakesEverySmallTriangleByTheRegionOfItsCentroid) {
  // After one level the centroids of the quarters are at x = −0.75 (twice), −0.5 (the rotated quarter) and 0.
  // With z = 1 their distances are √(1 + x²) beside the plate and 1 in front of it.
  const Triangle triangle{Eigen::Vector3d{-1, 0.2, 1}, {0.5, 0.2, 1}, {-1, 0.5, 1}};
  const double area = 1.5 * 0.3 / 2;
  const double beside = 2 / std::hypot(1, 0.75) + 1 / std::hypot(1, 0.5);
  EXPECT_DOUBLE_EQ(plate_integral(triangle, plate, Split{1}), area / 4 * (beside + 1));
}

TEST(GaussMethod, WithOnePointTakesThePointItsRuleNames) {
  // The single node has weight 1/2 at u = v = 1/2: the point halfway from the first vertex to the middle of
  // the opposite edge.
  const Triangle triangle{Eigen::Vector3d{0.1, 0.1, 0.5}, {0.8, 0.1, 0.4}, {0.4, 0.7, 0.8}};
  EXPECT_DOUBLE_EQ(plate_integral(triangle, plate, Gauss{1}), twice_area(triangle) * 0.5 / 0.55);
}

TEST(GaussMethod, ConvergesToTheExactIntegralWithinOneRegion) {
  for (const auto& [region, triangle] : triangles) {
    EXPECT_LT(relative_error(triangle, Gauss{4}), 1e-3) << region;
    EXPECT_LT(relative_error(triangle, Gauss{8}), 1e-6) << region;
    EXPECT_LT(relative_error(triangle, Gauss{64}), 4e-15) << region;
  }
}

TEST(EveryMethod, IsInfiniteWhereTheTriangleCrossesThePlate) {
  const Triangle crossing{Eigen::Vector3d{0.3, 0.3, -0.2}, {0.6, 0.3, 0.1}, {0.4, 0.6, 0.3}};
  for (const Method& method : {Method{Exact{}}, Method{Split{0}}, Method{Split{4}}, Method{Gauss{8}}})
    EXPECT_EQ(plate_integral(crossing, plate, method), std::numeric_limits<double>::infinity());
}

TEST(EveryMethod, IsZeroWithoutArea) {
  const Triangle through{Eigen::Vector3d{0.3, 0.3, -1}, {0.3, 0.3, 1}, {0.3, 0.3, 0}};
  for (const Method& method : {Method{Exact{}}, Method{Split{3}}, Method{Gauss{8}}})
    EXPECT_EQ(plate_integral(through, plate, method), 0);
}

TEST(EveryMethod, IsFiniteForATriangleInThePlatesPlaneBesideIt) {
  const Triangle beside{Eigen::Vector3d{-1, 0.1, 0}, {-2, 0.2, 0}, {-1.5, 0.7, 0}};
  const double exact = plate_integral(beside, plate);
  EXPECT_NEAR(plate_integral(beside, plate, Split{5}), exact, 1e-4 * exact);
  EXPECT_NEAR(plate_integral(beside, plate, Gauss{16}), exact, 1e-12 * exact);
}

TEST(EveryMethod, RefusesParametersOutOfRange) {
  const Triangle& triangle = triangles.front().triangle;
  for (const Method& method : {Method{Split{-1}}, Method{Split{11}}, Method{Gauss{0}}, Method{Gauss{65}},
                               Method{BoundaryElements{}}, Method{Reduced{}}, Method{Formula{}}})
    EXPECT_THROW(plate_integral(triangle, plate, method), InputError);
}

TEST(EveryMethod, RefusesAVertexThatIsNotFiniteAndNamesIt) {
  std::vector<Triangle> surface{triangles[0].triangle, triangles[1].triangle};
  surface[1][2].y() = std::numeric_limits<double>::quiet_NaN();
  for (const Method& method : {Method{Exact{}}, Method{Split{2}}, Method{Gauss{3}}})
    EXPECT_THAT([&] { plate_integrals(surface, plate, method); },
                ThrowsMessage<InputError>(testing::StrEq("triangle 1: vertex 2 is not finite")));
  EXPECT_THROW(plate_integral(surface[1], plate), InputError);
}

TEST(EveryMethod, RefusesAPlateThatIsNoRectangle) {
  EXPECT_THROW(plate_integral(triangles[0].triangle, {{0, 0, 0}, {1, 0, 0}, {0.1, 1, 0}}), InputError);
}

TEST(Method, IntegratesOverTrianglesOrIsForWholeScenes) {
  for (const Method& method : {Method{Exact{}}, Method{Split{4}}, Method{Gauss{8}}})
    EXPECT_TRUE(is_integral(method)) << to_string(method);
  for (const Method& method :
       {Method{Formula{}}, Method{Reduced{}}, Method{BoundaryElements{}}, Method{Auto{}}})
    EXPECT_FALSE(is_integral(method)) << to_string(method);
}

TEST(Method, TextReadsBackAsTheSameMethod) {
  for (const std::string text : {"exact", "split:0", "split:10", "gauss:1", "gauss:64", "formula", "reduced",
                                 "boundary-elements", "auto"})
    EXPECT_EQ(to_string(parse_method(text)), text);
}

TEST(Method, ThatIsNoneIsNamedInTheRefusal) {
  for (const std::string text :
       {"", "Exact", "exact ", "split", "split:", "split:-1", "split:11", "split:4.0", "split:4x", "gauss:0",
        "gauss:65", "gauss: 4", "formula+nearest", "reduced ", "Auto", "boundary-elements:3",
        "split:99999999999999999999"})
    EXPECT_THAT([&] { parse_method(text); }, ThrowsMessage<InputError>(HasSubstr("'" + text + "'")));
}

TEST(Method, OfBeforeIsRefusedWithWhatToWriteNow) {
  EXPECT_THAT([] { parse_method("recommended"); }, ThrowsMessage<InputError>(HasSubstr("write auto")));
  EXPECT_THAT([] { parse_method("reduced:2"); },
              ThrowsMessage<InputError>(HasSubstr("write reduced with rtol")));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
