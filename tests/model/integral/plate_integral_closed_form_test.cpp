#include "integral/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"

/// Tests integrals with elementary closed forms, which are derived beside the code, and the pieces that they
/// are added up from. The plate is 0 ≤ x ≤ 3, 0 ≤ y ≤ 2, z = 0.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::parallelogram;
using test::total_integral;

const Rectangle plate{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}};
constexpr double tolerance = 4e-15;

/// A surface whose integral has a closed form.
struct Known {
  const char* name;
  std::vector<Triangle> surface;
  double expected;
};

/// In front of the plate, in region I, the distance is the height.
std::vector<Known> in_front() {
  std::vector<Known> cases;
  for (const double height : {1e-9, 0.02, 1.0, 1e6})
    cases.push_back({"parallel: area over distance",
                     parallelogram({0.5, 0.25, height}, {2, 0, 0}, {0, 1.5, 0}), 3 / height});
  // At distance s from the line where the planes meet, d = s·sin θ: ∫dA/d = (w/sin θ)·ln(s₂/s₁)
  for (const double angle : {1e-3, 0.1, 0.7, 1.2}) {
    const double s1 = 0.1, s2 = 2.9, width = 1.5;
    const Vector3d slope(std::cos(angle), 0, std::sin(angle));
    cases.push_back({"inclined: a logarithm",
                     parallelogram(s1 * slope + Vector3d(0, 0.25, 0), (s2 - s1) * slope, {0, width, 0}),
                     width / std::sin(angle) * std::log(s2 / s1)});
  }
  // w·ln(z₂/z₁)
  cases.push_back(
      {"vertical: a logarithm", parallelogram({1, 0.5, 0.01}, {0, 1, 0}, {0, 0, 0.99}), std::log(100.0)});
  // A triangle of area A with vertex heights 0, h, h has a width proportional to height: ∫dA/d = ∫₀ʰ
  // (2A/h²)·z dz/z = 2A/h
  const Triangle on_tip{Vector3d{1, 1, 0}, {1.5, 1, 0.5}, {1.5, 1.5, 0.5}};
  cases.push_back({"touching with one vertex", {on_tip}, twice_area(on_tip) / 0.5});
  return cases;
}

/// Triangles beside the plate, in regions II and III, and across regions.
std::vector<Known> beside() {
  std::vector<Known> cases;
  // d = √(x² + z²): ∫dA/d = w·(asinh(b/z) − asinh(a/z))
  for (const double z : {1e-3, 0.4, 10.0})
    cases.push_back({"parallel strip: inverse hyperbolic sines",
                     parallelogram({-4, 0.25, z}, {3.5, 0, 0}, {0, 1.5, 0}),
                     1.5 * (std::asinh(4 / z) - std::asinh(0.5 / z))});
  // d = x − 3: ∫dA/d = w·ln(b/a)
  cases.push_back({"strip in the plate's plane", parallelogram({3.5, 0.25, 0}, {3.5, 0, 0}, {0, 1.5, 0}),
                   1.5 * std::log(8.0)});
  // In the plane y = 1 the plate's edge appears as a point, and in the plate's plane its corner is one. For a
  // right triangle with this point at its right angle and legs a: ∫dA/r = ∫ρ(φ)dφ = √2·a·asinh(1)
  const double a = 0.7, about_a_point = std::sqrt(2) * a * std::asinh(1);
  cases.push_back(
      {"across the edge's direction", {{Vector3d{0, 1, 0}, {-a, 1, 0}, {0, 1, a}}}, about_a_point});
  cases.push_back({"at the corner", {{Vector3d{0, 0, 0}, {-a, 0, 0}, {0, -a, 0}}}, about_a_point});
  // A parallel rectangle at height z that extends beyond the plate by b on every side. The integral is A/z in
  // front of the plate, asinh(b/z) per unit of length beside each edge, and the contribution of a b × b
  // square at each corner. A square consists of two right triangles with legs b whose acute angle (45°) is at
  // the corner. With R₀² = b² + z², R² = R₀² + b² it gives 2·(b·asinh(b/R₀) − z·atan(b²/(R₀² + z·R))).
  const double b = 0.8, z = 0.3;
  const double r0 = std::hypot(b, z), r = std::hypot(r0, b);
  const double corner = 2 * (b * std::asinh(b / r0) - z * std::atan(b * b / (r0 * r0 + z * r)));
  cases.push_back({"larger than the plate: the sum over the nine cells",
                   parallelogram({-b, -b, z}, {3 + 2 * b, 0, 0}, {0, 2 + 2 * b, 0}),
                   3.0 * 2.0 / z + 2 * (3 + 2) * std::asinh(b / z) + 4 * corner});
  return cases;
}

TEST(PlateIntegral, IsTheClosedForm) {
  for (const std::vector<Known>& cases : {in_front(), beside()})
    for (const auto& [name, surface, expected] : cases)
      EXPECT_NEAR(total_integral(surface, plate), expected, tolerance * expected) << name << ": " << expected;
}

TEST(PlateIntegral, OfATriangleAboveTheCornerHasALogarithmAndASolidAngle) {
  // A right triangle with legs a at height z, its right angle above the corner. Let p = a/√2 be the distance
  // from the right angle to the hypotenuse, t = p half the hypotenuse's length, R₀² = p² + z², R² = R₀² + t².
  // Then ∫dA/r = 2·(p·asinh(t/R₀) − z·atan(p·t/(R₀² + z·R)))
  const double a = 0.7;
  for (const double z : {0.001, 0.3, 5.0}) {
    const Triangle triangle{Vector3d{0, 0, z}, {-a, 0, z}, {0, -a, z}};
    const double p = a / std::sqrt(2), r0 = std::hypot(p, z), r = std::hypot(r0, p);
    const double expected = 2 * (p * std::asinh(p / r0) - z * std::atan(p * p / (r0 * r0 + z * r)));
    // For large z the reference formula itself loses digits: p·asinh(t/R₀) is z/p times the difference.
    EXPECT_NEAR(plate_integral(triangle, plate), expected, tolerance * (1 + z / p * z / p) * expected);
  }
}

/// Returns a triangle whose vertices, edges and plane lie on a plate's corners, edges and border planes up to
/// rounding.
LocalTriangle on_borders(const PlateFrame& plate, test::Random& random) {
  const auto rounded = [&] { return std::floor(random.uniform(-2, 3)) * 0x1p-53; };
  LocalTriangle triangle;
  for (Vector3d& vertex : triangle) {
    const double u = std::floor(random.uniform(-2, 4)) / 2, v = std::floor(random.uniform(-2, 4)) / 2;
    vertex = {u * plate.length_u + rounded(), v * plate.length_v + rounded(), random.uniform(0, 1)};
  }
  return triangle;
}

/// Computes how far a coordinate lies outside the strip.
double outside(Strip strip, double coordinate, double length) {
  switch (strip) {
  case Strip::below:
    return std::max(coordinate, 0.0);
  case Strip::within:
    return std::max({-coordinate, coordinate - length, 0.0});
  case Strip::above:
    return std::max(length - coordinate, 0.0);
  }
  return 0;
}

TEST(Pieces, AddUpToTheTriangleAndLieInTheirCellsWhateverRoundingSaysOfBorders) {
  PlateFrame plate;
  plate.length_u = 1.99995;
  plate.length_v = 0.577147;
  test::Random random(1);
  int in_several_cells = 0;
  for (int i = 0; i < test::draws(30000); ++i) {
    double shares = 0;
    int pieces = 0;
    for_each_piece(plate, on_borders(plate, random),
                   [&](Cell cell, const Vector3d& a, const Vector3d& b, const Vector3d& c, double share) {
                     shares += share;
                     ++pieces;
                     for (const Vector3d& corner : {a, b, c}) {
                       ASSERT_LT(outside(cell.u, corner.x(), plate.length_u), 1e-15);
                       ASSERT_LT(outside(cell.v, corner.y(), plate.length_v), 1e-15);
                     }
                   });
    ASSERT_NEAR(shares, 1, 1e-14);
    in_several_cells += pieces > 1;
  }
  EXPECT_GT(in_several_cells, test::draws(15000));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
