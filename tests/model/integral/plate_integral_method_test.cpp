#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/method.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/pose.hpp"
#include "geometry.hpp"
#include "integral/derivative/plate_wrench.hpp"

/// Compares the numerical methods with the exact one and the derivatives with respect to the triangle's pose
/// with differences, and tests the arguments that every method refuses.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Rectangle plate{{0, 0, 0}, {1, 0, 0}, {0, 0.8, 0}};

struct NamedTriangle {
  const char* region;
  Triangle triangle;
};

const std::vector<NamedTriangle> triangles{
    {"I", {Vector3d{0.1, 0.1, 0.5}, {0.8, 0.2, 0.7}, {0.3, 0.7, 0.9}}},
    {"II", {Vector3d{-0.5, 0.1, 0.2}, {-0.9, 0.3, 0.4}, {-0.4, 0.7, 0.6}}},
    {"III", {Vector3d{-0.5, -0.3, 0.2}, {-0.9, -0.2, 0.4}, {-0.4, -0.7, 0.6}}},
};

double relative_error(const Triangle& triangle, const Method& method) {
  const double exact = plate_integral(triangle, plate);
  return std::abs(plate_integral(triangle, plate, method) - exact) / exact;
}

TEST(SplitMethod, WithoutLevelsIsAreaOverTheCentroidsDistance) {
  // The centroid (0.4, 0.3, 0.6) lies in front of the plate.
  const Triangle triangle{Vector3d{0.1, 0.1, 0.5}, {0.8, 0.1, 0.4}, {0.3, 0.7, 0.9}};
  EXPECT_DOUBLE_EQ(plate_integral(triangle, plate, Split{0}), twice_area(triangle) / 2 / 0.6);
}

TEST(SplitMethod, TakesEverySmallTriangleByTheRegionOfItsCentroid) {
  // After one level the centroids of the quarters are at x = −0.75 (twice), −0.5 (the rotated quarter) and 0.
  // With z = 1 their distances are √(1 + x²) beside the plate and 1 in front of it.
  const Triangle triangle{Vector3d{-1, 0.2, 1}, {0.5, 0.2, 1}, {-1, 0.5, 1}};
  const double area = 1.5 * 0.3 / 2;
  const double beside = 2 / std::hypot(1, 0.75) + 1 / std::hypot(1, 0.5);
  EXPECT_DOUBLE_EQ(plate_integral(triangle, plate, Split{1}), area / 4 * (beside + 1));
}

TEST(GaussMethod, WithOnePointTakesThePointItsRuleNames) {
  // The single node has weight 1/2 at u = v = 1/2: the point halfway from the first vertex to the middle of
  // the opposite edge.
  const Triangle triangle{Vector3d{0.1, 0.1, 0.5}, {0.8, 0.1, 0.4}, {0.4, 0.7, 0.8}};
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
  const Triangle crossing{Vector3d{0.3, 0.3, -0.2}, {0.6, 0.3, 0.1}, {0.4, 0.6, 0.3}};
  for (const Method& method : {Method{Exact{}}, Method{Split{0}}, Method{Split{4}}, Method{Gauss{8}}})
    EXPECT_EQ(plate_integral(crossing, plate, method), std::numeric_limits<double>::infinity());
}

TEST(EveryMethod, IsZeroWithoutArea) {
  const Triangle through{Vector3d{0.3, 0.3, -1}, {0.3, 0.3, 1}, {0.3, 0.3, 0}};
  for (const Method& method : {Method{Exact{}}, Method{Split{3}}, Method{Gauss{8}}})
    EXPECT_EQ(plate_integral(through, plate, method), 0);
}

TEST(EveryMethod, IsFiniteForATriangleInThePlatesPlaneBesideIt) {
  const Triangle beside{Vector3d{-1, 0.1, 0}, {-2, 0.2, 0}, {-1.5, 0.7, 0}};
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

using test::motion_along;
using test::Random;
using Derivatives = Eigen::Matrix<double, 6, 1>;

/// Differentiates the integral by central differences with two steps, which cancels errors of second order.
/// Rotations are about the point.
Derivatives differences(const Triangle& triangle, const Rectangle& over, double step, const Vector3d& point) {
  Derivatives result;
  for (int k = 0; k < 6; ++k) {
    const auto central = [&](double by) {
      return (plate_integral(transformed(triangle, motion_along(k, by, point)), over) -
              plate_integral(transformed(triangle, motion_along(k, -by, point)), over)) /
             (2 * by);
    };
    result[k] = (4 * central(step) - central(2 * step)) / 3;
  }
  return result;
}

/// Returns the derivatives with rotations about the point.
Derivatives derivatives_about(const Triangle& triangle, const Rectangle& over, const Vector3d& point) {
  const IntegralDerivatives found = plate_integral_derivatives(triangle, over);
  Derivatives result;
  result << found.translation, found.rotation - point.cross(found.translation);
  return result;
}

/// Returns the largest difference from central differences, relative to the largest derivative of its kind:
/// along axes, or about axes through the first vertex.
double largest_error(const Triangle& triangle) {
  const double size = std::max((triangle[1] - triangle[0]).norm(), (triangle[2] - triangle[0]).norm());
  const double step = 1e-3 * std::min(test::distance_between(triangle, plate), 0.3);
  const Derivatives found = derivatives_about(triangle, plate, triangle[0]);
  const Vector3d along = differences(triangle, plate, step, triangle[0]).head<3>();
  const Vector3d about = differences(triangle, plate, std::min(step / size, 1e-2), triangle[0]).tail<3>();
  return std::max((found.head<3>() - along).norm() / along.norm(),
                  (found.tail<3>() - about).norm() / (size * along.norm()));
}

TEST(PlateIntegralDerivatives, AgreeWithCentralDifferencesInTenThousandPoses) {
  Random random(26);
  double largest = 0;
  for (int i = 0; i < test::draws(10'000); ++i) {
    const double size = std::pow(10.0, random.uniform(-3, 0.3)),
                 height = std::pow(10.0, random.uniform(-2, 0.5));
    const Triangle shape = random.triangle_in_box({-size, -size, -size}, {size, size, size});
    Eigen::Isometry3d motion = random.rigid_motion();
    motion.translation() = random.in_box({-0.5, -0.5, height}, {1.5, 1.3, 2 * height});
    Triangle triangle = transformed(shape, motion);
    // The lowest vertex lies at the height drawn, so that no triangle crosses the plate.
    const double lowest = std::min({triangle[0].z(), triangle[1].z(), triangle[2].z()});
    for (Vector3d& vertex : triangle)
      vertex.z() += height - lowest;
    largest = std::max(largest, largest_error(triangle));
  }
  EXPECT_LT(largest, 1e-5);
}

TEST(PlateIntegralDerivatives, AgreeForThinTrianglesAndThoseAlongTheAxes) {
  Random random(27);
  double largest = 0;
  for (int i = 0; i < test::draws(2'000); ++i) {
    const Vector3d corner = random.in_box({-1, -1, 0.05}, {2, 1.8, 0.5});
    const auto axis = static_cast<Eigen::Index>(random.uniform(0, 3));
    const Vector3d along = random.uniform(0.1, 2) * Vector3d::Unit(axis);
    const Vector3d across = std::pow(10.0, random.uniform(-5, 0)) * Vector3d::Unit((axis + 1) % 3);
    largest = std::max(largest, largest_error({corner, corner + along, corner + along + across}));
  }
  EXPECT_LT(largest, 1e-5);
}

TEST(PlateIntegralDerivatives, TurnWithEverything) {
  Random random(28);
  for (int i = 0; i < 100; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, 0.1}, {2, 1.8, 1});
    const Eigen::Isometry3d motion = random.rigid_motion();
    const Derivatives before = derivatives_about(triangle, plate, triangle[0]);
    const Derivatives after =
        derivatives_about(transformed(triangle, motion), transformed(plate, motion), motion * triangle[0]);
    EXPECT_TRUE((motion.linear() * before.head<3>()).isApprox(after.head<3>(), 1e-9));
    EXPECT_TRUE((motion.linear() * before.tail<3>()).isApprox(after.tail<3>(), 1e-9));
  }
}

TEST(PlateIntegralDerivatives, KeepTheirAccuracyInAnyUnitOfLength) {
  const Triangle triangle{Vector3d{-0.3, 0.2, 0.1}, Vector3d{0.8, 1.2, 0.3}, Vector3d{0.2, 0.6, 0.7}};
  const Derivatives expected = derivatives_about(triangle, plate, Vector3d::Zero());
  for (const double unit : {0x1p-100, 0x1p100}) {
    const Triangle scaled{unit * triangle[0], unit * triangle[1], unit * triangle[2]};
    const Derivatives found = derivatives_about(
        scaled, {unit * plate.corner, unit * plate.edge_u, unit * plate.edge_v}, Vector3d::Zero());
    EXPECT_TRUE(found.head<3>().isApprox(expected.head<3>(), 1e-12));
    EXPECT_TRUE((found.tail<3>() / unit).isApprox(expected.tail<3>(), 1e-12));
  }
}

TEST(PlateIntegralDerivatives, AreZeroWithoutArea) {
  const Triangle point{Vector3d{0.2, 0.2, 0.1}, Vector3d{0.2, 0.2, 0.1}, Vector3d{0.2, 0.2, 0.1}};
  EXPECT_TRUE(plate_integral_derivatives(point, plate).translation.isZero(0));
}

TEST(PlateIntegralDerivatives, AreNotANumberInContact) {
  const Vector3d tip(0.5, 0.4, 0), b(0.2, 0.1, 0.3), c(0.9, 0.5, 0.3);
  // A single common point leaves the integral finite, but not its derivatives.
  for (const Triangle& triangle :
       {Triangle{tip, b, c}, Triangle{Vector3d(0.5, 0.4, -0.3), b, c},
        Triangle{tip, Vector3d(0.7, 0.4, 0), c},
        Triangle{Vector3d(1, 0.2, 0), Vector3d(1.3, 0.1, 0), Vector3d(1.3, 0.3, 0)}}) {
    const IntegralDerivatives found = plate_integral_derivatives(triangle, plate);
    EXPECT_TRUE(found.translation.array().isNaN().all());
    EXPECT_TRUE(found.rotation.array().isNaN().all());
  }
}

TEST(PlateIntegralDerivatives, OfASurfaceAreTheSumOverItsTriangles) {
  Random random(29);
  std::vector<Triangle> triangles;
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();
  for (int i = 0; i < 1'100; ++i) {
    triangles.push_back(random.triangle_in_box({-1, -1, 0.1}, {2, 1.8, 1}));
    const IntegralDerivatives one = plate_integral_derivatives(triangles.back(), plate);
    force += one.translation;
    torque += one.rotation;
  }
  const detail::Wrench all = detail::plate_wrench(TriangleBatch(triangles), plate);
  EXPECT_TRUE(all.force.isApprox(force, 1e-9));
  EXPECT_TRUE(all.torque.isApprox(torque, 1e-9));
}

TEST(PlateIntegralDerivatives, RefuseWhatTheIntegralRefuses) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(
      plate_integral_derivatives({Vector3d{infinite, 0, 0}, Vector3d{1, 0, 1}, Vector3d{0, 1, 1}}, plate),
      InputError);
  EXPECT_THROW(plate_integral_derivatives({Vector3d{0, 0, 1}, Vector3d{1, 0, 1}, Vector3d{0, 1, 1}},
                                          {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}),
               InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
