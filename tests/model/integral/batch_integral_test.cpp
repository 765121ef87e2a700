#include "fringe/batch_integral.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::Random;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Rectangle plate{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
const Rectangle beside{{0.2, -0.05, 0.02}, {0.1, 0, 0}, {0, 0, 0.1}};

/// Returns a closed surface in front of the plates.
std::vector<Triangle> ellipsoid(int segments) {
  std::vector<Triangle> triangles = triangulate(Sphere{1, segments});
  for (Triangle& triangle : triangles)
    for (Vector3d& vertex : triangle)
      vertex = Vector3d(0.02, 0.01, 0.12) + Vector3d(0.15, 0.1, 0.06).cwiseProduct(vertex);
  return triangles;
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values)
    total += value;
  return total;
}

TEST(BatchIntegral, TotalsAreTheSumsForEveryPlate) {
  const TriangleBatch surface(ellipsoid(60));
  const std::vector<Rectangle> plates{plate, beside};
  const std::vector<BoundedIntegral> totals = total_integrals(surface, plates);
  ASSERT_EQ(totals.size(), 2);
  for (std::size_t i = 0; i < plates.size(); ++i) {
    EXPECT_NEAR(totals[i].value, sum(plate_integrals(surface, plates[i])), 1e-13 * totals[i].value);
    EXPECT_EQ(totals[i].bound, 0);
  }
}

TEST(BatchIntegral, BoundCoversTheError) {
  const TriangleBatch surface(ellipsoid(60));
  const std::vector<Rectangle> plates{plate, beside};
  const std::vector<BoundedIntegral> exact = total_integrals(surface, plates);
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    const std::vector<BoundedIntegral> totals = total_integrals(surface, plates, tolerance);
    for (std::size_t i = 0; i < plates.size(); ++i) {
      EXPECT_LE(totals[i].bound, 1.01 * tolerance * totals[i].value);
      EXPECT_NEAR(totals[i].value, exact[i].value, totals[i].bound + 1e-14 * exact[i].value);
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

TEST(BatchIntegral, ContactIsInfinite) {
  const TriangleBatch surface(std::vector<Triangle>{{Vector3d(0, 0, -0.1), {0.01, 0, 0.1}, {0, 0.01, 0.1}},
                                                    {Vector3d(0, 0, 0.1), {0.01, 0, 0.1}, {0, 0.01, 0.1}}});
  EXPECT_EQ(total_integrals(surface, std::vector{plate}).at(0).value,
            std::numeric_limits<double>::infinity());
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

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
