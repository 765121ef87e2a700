#include "fringe/batch_integral.hpp"
#include "integral/surface_integral.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"

/// ∫dA/d over whole surfaces: what encloses it, by which rules it is summed, and its derivatives.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Rectangle plate{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
const Rectangle beside{{0.2, -0.05, 0.02}, {0.1, 0, 0}, {0, 0, 0.1}};

/// Returns a closed surface in front of the plates.
std::vector<Triangle> ellipsoid(int segments) {
  return test::moved(triangulate(Ellipsoid{0.15, 0.1, 0.06, segments}),
                     Isometry3d(Eigen::Translation3d(0.02, 0.01, 0.12)));
}

TEST(BatchIntegral, TotalsAreTheSumsForEveryPlateWithinTheirBounds) {
  const std::vector<Triangle> triangles = ellipsoid(60);
  const TriangleBatch surface(triangles);
  const std::vector<Rectangle> plates{plate, beside};
  for (const double tolerance : {0.0, 1e-3, 1e-6, 1e-9}) {
    const std::vector<BoundedIntegral> totals = total_integrals(surface, plates, tolerance);
    ASSERT_EQ(totals.size(), 2);
    for (std::size_t i = 0; i < plates.size(); ++i) {
      const double exact = test::total_integral(triangles, plates[i]);
      EXPECT_LE(totals[i].bound, 1.01 * tolerance * totals[i].value);
      EXPECT_NEAR(totals[i].value, exact, totals[i].bound + 1e-13 * exact);
    }
  }
}

TEST(BatchIntegral, IsTheSameBitByBitForAnyNumberOfThreads) {
  const TriangleBatch surface(ellipsoid(200));
  const std::vector<Rectangle> plates{plate, beside};
  const std::vector<double> one = plate_integrals(surface, plate, 0, 1);
  const std::vector<BoundedIntegral> one_total = total_integrals(surface, plates, 0, 1);
  for (const int threads : {0, 2, 3}) {
    EXPECT_EQ(plate_integrals(surface, plate, 0, threads), one);
    const std::vector<BoundedIntegral> totals = total_integrals(surface, plates, 0, threads);
    for (std::size_t i = 0; i < plates.size(); ++i)
      EXPECT_EQ(totals[i].value, one_total[i].value);
  }
}

TEST(BatchIntegral, OfANeedleThatIsAPointInThePlatesCoordinatesIsANumber) {
  // The needle is one unit in the last place wide. It lies beside the plate's edge and along it, so that both
  // of its ends are equally far away.
  const Rectangle away{{1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const double next = std::nextafter(0.1, 1.0);
  const Triangle needle{{{0.1, 0.2, 1}, {0.1, 0.7, 1}, {next, 0.7, 1}}};
  const double expected = 0.5 * (next - 0.1) * 0.5 / std::hypot(0.9, 1.0);
  EXPECT_NEAR(plate_integral(needle, away), expected, 1e-15 * expected);
  EXPECT_NEAR(plate_integrals(TriangleBatch({&needle, 1}), away)[0], expected, 1e-15 * expected);
}

TEST(BatchIntegral, OfNoTrianglesIsZero) {
  const TriangleBatch nothing({});
  EXPECT_TRUE(plate_integrals(nothing, plate).empty());
  EXPECT_EQ(total_integrals(nothing, std::vector{plate}).at(0).value, 0);
}

TEST(BatchIntegral, ContactIsInfiniteWhereADenormalNumberMakesIt) {
  constexpr double least = std::numeric_limits<double>::denorm_min();
  const Rectangle small{{0, 0, 0}, {0x1p-11, 0, 0}, {0, 0x1p-11, 0}};
  // The triangle crosses the plate; the part of it beside the plate has an area that underflows.
  const Triangle through{
      {{0x1p-13, 0x1p-11, 0x1p-15}, {-least, 0x1p-13, -0x1p-11}, {0x1p-14, 0x1p-12, -0x1p-13}}};
  // The triangle stands upright on the plate's edge and meets it at one vertex.
  const Triangle upright{{{0, 0x1p-12, least}, {0, 0x1p-12, -0x1p-11}, {0, 0x1p-13, -0x1p-11}}};
  for (const Triangle& triangle : {through, upright}) {
    EXPECT_EQ(plate_integral(triangle, small), std::numeric_limits<double>::infinity());
    EXPECT_EQ(plate_integrals(TriangleBatch({&triangle, 1}), small)[0],
              std::numeric_limits<double>::infinity());
  }
}

TEST(BatchIntegral, GivesBackItsTriangles) {
  const std::vector<Triangle> triangles = ellipsoid(10);
  const TriangleBatch surface(triangles);
  ASSERT_EQ(surface.size(), triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    EXPECT_EQ(surface[i], triangles[i]);
    EXPECT_NEAR(surface.twice_area()[i], twice_area(triangles[i]), 1e-15 * twice_area(triangles[i]));
  }
}

TEST(BatchIntegral, RefusesWhatIsWrongByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Triangle> triangles{{Vector3d(0, 0, 1), {1, 0, 1}, {0, 1, 1}},
                                        {Vector3d(0, 0, 1), {1, 0, nan}, {0, 1, 1}}};
  EXPECT_THAT([&] { TriangleBatch{triangles}; },
              ThrowsMessage<InputError>(HasSubstr("triangle 1: vertex 1 is not finite")));
  const TriangleBatch surface{std::span(triangles).first(1)};
  EXPECT_THAT([&] { plate_integrals(surface, plate, -1e-3); },
              ThrowsMessage<InputError>(HasSubstr("tolerance -0.001")));
  EXPECT_THAT([&] { plate_integrals(surface, plate, nan); },
              ThrowsMessage<InputError>(HasSubstr("tolerance nan")));
  EXPECT_THAT([&] { plate_integrals(surface, plate, 0, -1); },
              ThrowsMessage<InputError>(HasSubstr("threads -1")));
  const std::vector<Rectangle> plates{plate, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}};
  EXPECT_THAT([&] { total_integrals(surface, plates); }, ThrowsMessage<InputError>(HasSubstr("plate 1: ")));
}

const std::vector<Rectangle> plates{{{-0.5, -0.4, 0}, {1, 0, 0}, {0, 0.8, 0}},
                                    {{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

const std::vector<Triangle> ball =
    test::moved(triangulate(Sphere{0.3, 10}), Isometry3d(Eigen::Translation3d(0.2, 0.1, 0.8)));

TEST(SurfaceIntegral, IsTheSumOverTrianglesAndPlatesAndLiesInItsEnclosure) {
  const Surface surface = make_surface(ball);
  double expected = 0;
  for (const Rectangle& plate : plates)
    expected += test::total_integral(ball, plate);
  const SurfaceIntegral found = surface_integral(surface, plates, {}, 0);
  EXPECT_NEAR(found.value, expected, 1e-13 * expected);
  EXPECT_EQ(found.bound, 0);
  const std::vector<PlateFrame> frames{plate_frame(plates[0]), plate_frame(plates[1])};
  const Enclosure bounds = enclosure(surface, surface.centroid, frames);
  EXPECT_LT(bounds.lower, expected);
  EXPECT_GT(bounds.upper, expected);
  EXPECT_LT(bounds.upper - bounds.lower, expected);
}

TEST(SurfaceIntegral, MeasuresTheSurface) {
  const Surface surface =
      make_surface(test::moved(triangulate(Cuboid{1, 2, 3}), Isometry3d(Eigen::Translation3d(4, 5, 6))));
  EXPECT_NEAR(surface.area, 22, 1e-13);
  EXPECT_LT((surface.centroid - Vector3d(4, 5, 6)).norm(), 1e-13);
  EXPECT_NEAR(surface.radius, std::sqrt(14) / 2, 1e-13);
  // A face of sides a and b at the distance c/2 from the centroid has the moment ab·((a² + b²)/12 + c²/4).
  const auto of_face = [](double a, double b, double c) {
    return 2 * a * b * ((a * a + b * b) / 12 + c * c / 4);
  };
  EXPECT_NEAR(surface.squared_radius_moment, of_face(1, 2, 3) + of_face(2, 3, 1) + of_face(3, 1, 2), 1e-12);
}

// Splitting is of second order: from one level to the next, a quarter of the error is left.
TEST(SurfaceIntegral, BySplittingAndByGaussConverges) {
  const Triangle triangle{Vector3d(-0.2, -0.3, 0.4), Vector3d(0.3, -0.2, 0.5), Vector3d(0, 0.3, 0.6)};
  const double exact = plate_integral(triangle, plates[0]);
  double before = std::abs(plate_integral(triangle, plates[0], Split{1}) - exact);
  for (int levels = 2; levels < 6; ++levels) {
    const double error = std::abs(plate_integral(triangle, plates[0], Split{levels}) - exact);
    EXPECT_NEAR(error / before, 0.25, 0.03) << levels;
    before = error;
  }
  EXPECT_NEAR(plate_integral(triangle, plates[0], Gauss{12}), exact, 1e-13);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
