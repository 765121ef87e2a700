#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "../model/geometry.hpp"
#include "fringe/batch_integral.hpp"
#include "fringe/distance_sensor.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "fringe/plate_integral.hpp"
#include "fuzz_targets.hpp"

/// The targets that decode numbers.
namespace fringe::fuzz {
namespace {

/// Decodes numbers from bytes; returns zeros when the bytes are used up.
class Input {
 public:
  explicit Input(Bytes bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }
  std::uint8_t byte();

  /// Decodes a point. The input's first byte selects the kind of number: either arbitrary bits, or sixteenths
  /// of small integers times a power of two, exactly or a few units in the last place off. The latter often
  /// give contact, collinear and coplanar points.
  Eigen::Vector3d point();
  double number();

 private:
  Bytes bytes_;
  bool any_bits_ = false;
  bool beside_ = false;
  int exponent_ = 0;
  bool begun_ = false;
};

std::uint8_t Input::byte() {
  if (bytes_.empty())
    return 0;
  const std::uint8_t first = bytes_.front();
  bytes_ = bytes_.subspan(1);
  return first;
}

double Input::number() {
  if (!begun_) {
    begun_ = true;
    const std::uint8_t kind = byte();
    any_bits_ = kind % 4 == 0;
    // The scale is mostly 1, otherwise between the smallest and the largest numbers.
    beside_ = kind / 4 % 2 == 1;
    exponent_ = kind % 4 == 1 ? 8 * static_cast<std::int8_t>(byte()) : 0;
  }
  if (any_bits_) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i)
      bits = bits << 8U | byte();
    return std::bit_cast<double>(bits);
  }
  const double sixteenths = static_cast<std::int8_t>(byte());
  double value = std::ldexp(sixteenths, exponent_ - 4);
  if (beside_)
    for (int units = static_cast<std::int8_t>(byte()) % 4; units != 0; units -= units > 0 ? 1 : -1)
      value = std::nextafter(value, units > 0 ? HUGE_VAL : -HUGE_VAL);
  return value;
}

Eigen::Vector3d Input::point() {
  const double x = number(), y = number(), z = number();
  return {x, y, z};
}

/// Returns whether all numbers are within the limit of a scene file.
bool in_a_scene(const std::vector<Eigen::Vector3d>& points) {
  constexpr double most = 1e30;
  return std::all_of(points.begin(), points.end(),
                     [](const Eigen::Vector3d& point) { return point.cwiseAbs().maxCoeff() <= most; });
}

/// Returns whether the points are in the range without overflow and denormal numbers, where properties of the
/// exact answer also hold for the rounded one.
bool ordinary(const std::vector<Eigen::Vector3d>& points) {
  constexpr double least = 1e-60, most = 1e60;
  for (const Eigen::Vector3d& point : points)
    for (const double value : point)
      if (!(value == 0 || (std::abs(value) >= least && std::abs(value) <= most)))
        return false;
  return true;
}

/// Computes the greatest distance between a vertex of the triangle and a corner of the plate, which bounds
/// the distance of any two of their points.
double greatest_distance(const Triangle& triangle, const Rectangle& plate) {
  double greatest = 0;
  for (const Eigen::Vector3d& vertex : triangle)
    for (const int corner : {0, 1, 2, 3})
      greatest = std::max(
          greatest,
          (vertex - plate.corner - (corner % 2) * plate.edge_u - (corner / 2) * plate.edge_v).stableNorm());
  return greatest;
}

/// Thresholds relative to the greatest distance and to its square.
constexpr double near_contact = 1e-6, thin = 1e-6;

}  // namespace

void plate_integral(Bytes bytes) {
  Input input(bytes);
  const Triangle triangle{input.point(), input.point(), input.point()};
  Rectangle plate{input.point(), input.point(), input.point()};
  // Random bytes seldom give a right angle, so mostly the second edge is replaced by a vector perpendicular
  // to the first.
  if (input.byte() % 4 != 0)
    plate.edge_v = plate.edge_u.cross(plate.edge_v);
  try {
    const double integral = fringe::plate_integral(triangle, plate);
    const double in_a_batch = plate_integrals(TriangleBatch({&triangle, 1}), plate).front();
    if (!in_a_scene({triangle[0], triangle[1], triangle[2], plate.corner, plate.edge_u, plate.edge_v}))
      return;
    if (!(integral >= 0 && in_a_batch >= 0))
      for (const Eigen::Vector3d& point :
           {triangle[0], triangle[1], triangle[2], plate.corner, plate.edge_u, plate.edge_v})
        fmt::print(stderr, "({:a}, {:a}, {:a})\n", point.x(), point.y(), point.z());
    require(integral >= 0, "the integral is a number, and not below zero");
    require(in_a_batch >= 0, "in a batch, too, it is a number, and not below zero");
    const Triangle turned{triangle[1], triangle[2], triangle[0]};
    const double again = fringe::plate_integral(turned, plate);
    const bool comparable =
        ordinary({triangle[0], triangle[1], triangle[2], plate.corner, plate.edge_u, plate.edge_v});
    if (!comparable)
      return;
    constexpr double rounding = 1e-9;
    const double greatest = greatest_distance(triangle, plate);
    require(!(integral < twice_area(triangle) / 2 / greatest * (1 - rounding)),
            "it is at least area over the greatest distance");
    // Close to contact, rounding decides, and it does so in the same way whichever vertex comes first. But
    // the area of vertices that are collinear up to rounding does depend on the order.
    const bool apart = test::distance_between(triangle, plate) >= near_contact * greatest;
    if (apart || twice_area(triangle) >= thin * greatest * greatest)
      require(again == integral || std::abs(again - integral) <= rounding * integral,
              "it is the same whichever vertex comes first");
    if (apart)
      require(std::abs(in_a_batch - integral) <= rounding * integral, "it is the same alone and in a batch");
    require(std::isfinite(integral) || !apart, "it is finite without contact");
  } catch (const InputError&) {
    // The input is not finite, or the plate is not a rectangle.
  }
}

void gjk_intersects(Bytes bytes) {
  // Largest number of vertices of a set: slightly more than a box has.
  constexpr std::size_t most_vertices = 12;
  Input input(bytes);
  std::vector<Eigen::Vector3d> a, b;
  for (std::vector<Eigen::Vector3d>* set : {&a, &b}) {
    const std::size_t count = input.byte() % (most_vertices + 1);
    for (std::size_t i = 0; i < count; ++i)
      set->push_back(input.point());
  }
  try {
    const GjkAnswer answer = fringe::gjk_intersects(a, b);
    require(proves(answer, a, b), "the certificate proves the answer");
    require(fringe::gjk_intersects(b, a).intersects == answer.intersects, "the order does not matter");
    const GjkDistance distance = gjk_distance(a, b);
    require((distance.distance == 0) == answer.intersects || !ordinary(a) || !ordinary(b),
            "the distance is zero when they intersect, and only then");
    require(distance.distance >= 0, "the distance is a number, and not below zero");
  } catch (const InputError&) {
    // A set is empty or not finite.
  }
}

void cone_closest(Bytes bytes) {
  constexpr std::size_t most_triangles = 6;
  Input input(bytes);
  SensingCone cone{input.point(), input.point(), 0, 0};
  // Angles from the narrowest to the half space.
  cone.full_angle = std::ldexp(1 + input.byte() % 200, -(input.byte() % 8)) / 64;
  cone.range = std::abs(input.number());
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < most_triangles && !input.empty(); ++i)
    triangles.push_back({input.point(), input.point(), input.point()});
  try {
    const auto seen = fringe::cone_closest(triangles, cone, ConeMethod::field_of_view);
    const auto other = fringe::cone_closest(triangles, cone, ConeMethod::cone_equation);
    if (seen) {
      require(seen->distance >= 0 && seen->point.allFinite(), "what is seen has a place");
      require(seen->triangle < triangles.size(), "what is seen is one of the triangles");
    }
    std::vector<Eigen::Vector3d> points{cone.apex, cone.direction, {cone.range, 0, 0}};
    for (const Triangle& triangle : triangles)
      points.insert(points.end(), triangle.begin(), triangle.end());
    if (!ordinary(points))
      return;
    // Rounding, of the angle by 2^-50, decides what happens at the cone's boundary. A triangle that is seen
    // with certainty is also seen by a slightly wider cone.
    constexpr double rounding = 1e-12;
    SensingCone wider = cone;
    wider.full_angle = std::min(cone.full_angle * (1 + rounding), 3.141592653589793);
    wider.range *= 1 + rounding;
    // In units of the farthest vertex: distances below `lost` may or may not count as the apex, and a
    // distance is rounded by some 2^-100 (NUMERICS, section 14).
    constexpr double lost = 0x1p-88, trace = 0x1p-98;
    double size = 0;
    for (const Eigen::Vector3d& point : points)
      size = std::max(size, point.cwiseAbs().maxCoeff());
    wider.range += trace * size;
    for (const auto& found : {seen, other}) {
      if (!found || found->distance <= lost * size)
        continue;
      require(found->distance <= wider.range, "what is seen is in the range");
      for (const ConeMethod method : {ConeMethod::field_of_view, ConeMethod::cone_equation}) {
        const auto surely = fringe::cone_closest(triangles, wider, method);
        require(surely && surely->distance <= found->distance * (1 + rounding) + trace * size,
                "a wider cone sees no less");
      }
    }
  } catch (const InputError&) {
    // The input is not finite, or is not a cone.
  }
}

}  // namespace fringe::fuzz
