#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"
#include "integral/kernel.hpp"

/// Tests what the classes of plate_integral_stress do not reach: numbers near the ends of the range of
/// doubles, edges whose squared length is not representable, and triangles that, up to rounding, touch a
/// rotated plate or lie in its plane or in a border plane. Rounding decides whether these are in contact, and
/// the decision must not depend on which vertex comes first. The stress program tests the value of the
/// integral at triangles without area, in contact, in planes between two regions, thin or nearly parallel to
/// the plate.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::Random;

const Rectangle plate{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}};
constexpr double infinity = std::numeric_limits<double>::infinity();

void expect_close(double value, double expected, double tolerance = 4e-15) {
  EXPECT_NEAR(value, expected, tolerance * expected);
}

TEST(PlateIntegralOnThePlate, DivergesWhereMoreThanAPointOfTheTriangleIsOnIt) {
  for (const Triangle& triangle : {
           Triangle{Vector3d{1, 1, 0}, {2, 1, 0}, {1, 2, 0}},        // lies on it
           Triangle{Vector3d{-1, 1, 0}, {1, 1, 0}, {-1, 2, 0}},      // in part
           Triangle{Vector3d{1, 1, -1}, {2, 1, 1}, {1, 2, 1}},       // crosses it
           Triangle{Vector3d{-1, 1, -2}, {1, 1, 1}, {-1, 1.5, 1}},   // in part
           Triangle{Vector3d{0, 0.5, -1}, {0, 1.5, -1}, {0, 1, 1}},  // through its edge
           Triangle{Vector3d{1, 1, 0}, {2, 1, 0}, {1, 1, 1}},        // with an edge
           Triangle{Vector3d{0, 0.5, 0}, {0, 1.5, 0}, {-1, 1, 0}},   // edge on edge
           Triangle{Vector3d{0, -1, 0}, {0, 3, 0}, {-1, 1, 1}},      // edge over edge
       })
    EXPECT_EQ(plate_integral(triangle, plate), infinity);
}

TEST(PlateIntegralFarAway, EndsWhereDifferencesOfCoordinatesOverflow) {
  EXPECT_EQ(detail::kernel({infinity, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0);
  const Rectangle far{{-1.5e308, 0, 0}, {3, 0, 0}, {0, 2, 0}};
  const Triangle triangle{Vector3d{1.5e308, 0, 1}, {1.5e308, 1e300, 1}, {1.5e308, 0, 1e300}};
  EXPECT_FALSE(plate_integral(triangle, far) > 0);
}

TEST(PlateIntegralInABorderPlane, KeepsItsDigitsNextToThePlatesEdge) {
  // Here d = z, so the integral is twice the area times the second divided difference of z·ln z over the
  // three heights, which is 56.330799391238285179 to 20 digits. Two edges have equal lengths up to rounding.
  const double small = 0x1p-53;
  for (const double x : {0.0, 3.0})
    expect_close(plate_integral({Vector3d{x, 0.5, 0.625}, {x, 1, small}, {x, 1.5, 1.125 * small}}, plate),
                 0.3125 * 56.330799391238285);
}

TEST(PlateIntegralNextToThePlate, DoesNotOverflowWhereHeightsHaveNoRatio) {
  // In front of the plate, the integral divided by twice the area is 1/h for one vertex at height 0 and two
  // at h, and (ln(h/z) − 1)/h for two vertices at z, where h/z overflows.
  const double z = 1e-315, h = 29;
  const Triangle one{Vector3d{1, 1, z}, {2, 1, h}, {1, 1.5, h}},
      two{Vector3d{1, 1, z}, {2, 1, z}, {1, 1.5, h}};
  const double mean_of_two = (std::log(h) - std::log(z) - 1) / h;
  expect_close(plate_integral(one, plate), twice_area(one) / h);
  expect_close(plate_integral(two, plate), twice_area(two) * mean_of_two);
  const std::vector<double> together = plate_integrals(std::vector{one, two}, plate);
  expect_close(together[0], twice_area(one) / h);
  expect_close(together[1], twice_area(two) * mean_of_two);
}

TEST(Kernel, IsANumberWhereLengthsHaveNoPowerOfTwoThatScalesThem) {
  // K is homogeneous of degree −1 and overflows for the smallest lengths.
  const auto of_size = [](double length) {
    return detail::kernel({length, 0, 0}, {0, length, 0}, {0, 0, length});
  };
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(of_size(least), infinity);
  EXPECT_NEAR(of_size(0x1p-1022) * 0x1p-1022, of_size(1), 1e-15);
}

TEST(PlateIntegral, IsANumberNextToEveryFeatureOfThePlate) {
  Random random(11);
  for (double distance = 1e-300; distance < 1; distance *= 1e10)
    for (const Vector3d& feature :
         {Vector3d(1, 1, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 0), Vector3d(3, 2, 0)})
      for (int i = 0; i < 20; ++i) {
        const Vector3d near = feature + distance * random.in_box({-1, -1, 0}, {1, 1, 1});
        const Triangle triangle{near, random.in_box({-1, -1, 0}, {4, 3, 2}),
                                random.in_box({-1, -1, 0}, {4, 3, 2})};
        const double value = plate_integral(triangle, plate);
        EXPECT_GT(value, 0);
        EXPECT_FALSE(std::isnan(value));
      }
}

TEST(PlateIntegralOnThePlate, DivergesOnTheFarEdgeOfAnyLength) {
  // The triangle's edge coincides exactly with the plate's edge y = length. The squares of most lengths are
  // not representable.
  for (double length = 0.05; length < 2; length *= 1.01) {
    const Rectangle plate{{0, 0, 0}, {0, length, 0}, {1, 0, 0}};
    EXPECT_TRUE(std::isinf(
        plate_integral({Vector3d{0.25, length, 0}, {0.75, length, 0}, {0.5, 2 * length, 1}}, plate)));
  }
}

TEST(PlateIntegral, GrowsInProportionToTheUnitOfLength) {
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, 0.1}, {4, 3, 1});
    const double expected = plate_integral(triangle, plate);
    for (const double factor : {1e-9, 0.37, 1e7}) {
      const Triangle scaled{factor * triangle[0], factor * triangle[1], factor * triangle[2]};
      const Rectangle scaled_plate{factor * plate.corner, factor * plate.edge_u, factor * plate.edge_v};
      expect_close(plate_integral(scaled, scaled_plate), factor * expected, 2e-14);
    }
  }
}

/// Length in m above the rounding errors of coordinates, which are of the order of 1 m here.
constexpr double rounding = 0x1p-49;

/// A triangle next to a plate.
struct Touching {
  Rectangle plate;
  Triangle triangle;
};

enum class Contact { edge_on_edge, edge_beside_edge, in_plane, in_border_plane, across_edge };
constexpr std::array contacts{Contact::edge_on_edge, Contact::edge_beside_edge, Contact::in_plane,
                              Contact::in_border_plane, Contact::across_edge};

Touching touching(Contact contact, Random& random) {
  const Eigen::Isometry3d turn = random.rigid_motion();
  const double length_u = random.uniform(0.5, 2), length_v = random.uniform(0.5, 2);
  const Rectangle plate{turn.translation(), turn.linear() * Vector3d(length_u, 0, 0),
                        turn.linear() * Vector3d(0, length_v, 0)};
  // Converts a position in units of the plate's edges and of 1 m along its normal. The callers use braces,
  // which draw random numbers in order with every compiler.
  const auto at = [&](const Vector3d& place) -> Vector3d {
    return plate.corner + place.x() * plate.edge_u + place.y() * plate.edge_v +
           place.z() * turn.linear().col(2);
  };
  const auto multiple = [&] { return std::floor(random.uniform(-4, 9)) / 4; };
  const auto anywhere = [&] {
    return at({random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 1)});
  };
  switch (contact) {
  case Contact::edge_on_edge:
    return {plate, {plate.corner, plate.corner + plate.edge_u, anywhere()}};
  case Contact::edge_beside_edge:
    return {plate, {at({multiple(), 0, 0}), at({multiple(), 0, 0}), anywhere()}};
  case Contact::in_plane:
    return {plate,
            {at({multiple(), 0, 0}), at({multiple(), multiple(), 0}), at({multiple(), multiple(), 0})}};
  case Contact::in_border_plane:
    return {
        plate,
        {at({1, multiple(), multiple()}), at({1, multiple(), multiple()}), at({1, multiple(), multiple()})}};
  case Contact::across_edge:
    return {plate,
            {at({multiple(), 0, -random.uniform(0, 1)}), at({multiple(), 0, random.uniform(0, 1)}),
             at({multiple(), 0, random.uniform(0, 1)})}};
  }
  return {};
}

std::vector<Triangle> in_all_orders(const Triangle& triangle) {
  std::vector<Triangle> orders;
  std::array<std::size_t, 3> order{0, 1, 2};
  do
    orders.push_back({triangle[order[0]], triangle[order[1]], triangle[order[2]]});
  while (std::next_permutation(order.begin(), order.end()));
  return orders;
}

/// Checks that the integral is the same whichever vertex comes first, up to the rounding of the area, and in
/// a batch.
void expect_same_in_all_orders(const Touching& scene, double integral) {
  const std::vector<Triangle> orders = in_all_orders(scene.triangle);
  const std::vector<double> batched = plate_integrals(orders, scene.plate);
  for (std::size_t i = 0; i < orders.size(); ++i) {
    const double value = plate_integral(orders[i], scene.plate);
    if (value != integral) {
      ASSERT_NEAR(value, integral, 4e-15 * integral);
    }
    if (batched[i] != integral) {
      ASSERT_NEAR(batched[i], integral, 1e-13 * integral) << "in a batch";
    }
  }
}

/// Checks that an infinite integral is within rounding of contact.
void expect_contact_if_infinite(const Touching& scene, double integral) {
  if (std::isfinite(integral))
    return;
  ASSERT_LE(test::distance_between(scene.triangle, scene.plate), rounding);
}

/// Checks that the integral is at least that of the triangle moved away by more than rounding.
void expect_at_least_that_farther_away(const Touching& scene, double integral) {
  const auto& [corner, u, v] = scene.plate;
  double least = infinity;
  for (const Vector3d& along : {u.normalized(), v.normalized(), u.cross(v).normalized()})
    for (const double distance : {-16 * rounding, 16 * rounding}) {
      Triangle moved = scene.triangle;
      for (Vector3d& vertex : moved)
        vertex += distance * along;
      least = std::min(least, plate_integral(moved, scene.plate));
    }
  ASSERT_GE(integral, least * (1 - 1e-12));
}

TEST(PlateIntegralAtATurnedPlate, IsDecidedByRoundingInOneWay) {
  Random random(5);
  for (const Contact contact : contacts) {
    int infinite = 0, finite = 0;
    for (int i = 0; i < test::draws(3000); ++i) {
      const Touching scene = touching(contact, random);
      if (twice_area(scene.triangle) < 1e-9)
        continue;
      const double integral = plate_integral(scene.triangle, scene.plate);
      expect_same_in_all_orders(scene, integral);
      expect_contact_if_infinite(scene, integral);
      expect_at_least_that_farther_away(scene, integral);
      ++(std::isinf(integral) ? infinite : finite);
    }
    EXPECT_GT(std::min(infinite, finite), test::draws(300)) << "rounding decides either way";
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
