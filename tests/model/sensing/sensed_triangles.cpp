#include "sensed_triangles.hpp"

#include <cmath>
#include <numbers>

namespace fringe::test {
namespace {

using Eigen::Vector3d;

constexpr double far_enough = 1e6;

Vector3d in_cube(Random& random) {
  return random.in_box({-1, -1, -1}, {1, 1, 1});
}

Triangle any_triangle(Random& random) {
  return random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
}

Vector3d point_of(const Triangle& triangle, Random& random) {
  const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
  return triangle[0] + u * (triangle[1] - triangle[0]) + v * (triangle[2] - triangle[0]);
}

SensingCone any_cone(Random& random) {
  return {in_cube(random), in_cube(random), random.uniform(0.01, 3.14), far_enough};
}

/// Returns a random point of the triangle's plane, often outside the triangle.
Vector3d point_around(const Triangle& triangle, Random& random) {
  const double u = random.uniform(-0.5, 1.5), v = random.uniform(-0.5, 1.5);
  return triangle[0] + u * (triangle[1] - triangle[0]) + v * (triangle[2] - triangle[0]);
}

/// Returns a cone whose axis misses a point by up to twice its half angle, so that half of the cones contain
/// the point.
SensingCone cone_towards(const Vector3d& apex, const Vector3d& point, double full_angle, Random& random) {
  const Vector3d sight = point - apex;
  const Vector3d aside = sight.cross(in_cube(random)).normalized() * sight.norm();
  return {apex, sight + std::tan(std::min(1.4, random.uniform(0, full_angle))) * aside, full_angle,
          far_enough};
}

SensedTriangle generic(Random& random) {
  const Triangle triangle = any_triangle(random);
  return {triangle, any_cone(random)};
}

SensedTriangle narrow(Random& random) {
  const Triangle triangle = any_triangle(random);
  const double angle = std::pow(10, random.uniform(-8, -1));
  return {triangle, cone_towards(in_cube(random), point_around(triangle, random), angle, random)};
}

SensedTriangle wide(Random& random) {
  const Triangle triangle = any_triangle(random);
  SensingCone cone = any_cone(random);
  cone.full_angle = std::numbers::pi - std::pow(10, random.uniform(-6, -1));
  return {triangle, cone};
}

/// Returns a cone whose axis is parallel to the triangle's plane or lies in it.
SensedTriangle axis_parallel_to_plane(Random& random) {
  const Triangle triangle = any_triangle(random);
  SensingCone cone = any_cone(random);
  cone.direction = triangle[1] - triangle[0];
  return {triangle, cone};
}

/// Returns a cone whose axis meets the plane behind the apex, where the mirror cone is.
SensedTriangle plane_behind(Random& random) {
  const Triangle triangle = any_triangle(random);
  SensingCone cone = any_cone(random);
  const Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  if ((cone.direction.dot(normal) > 0) == ((triangle[0] - cone.apex).dot(normal) > 0))
    cone.direction = -cone.direction;
  cone.full_angle = random.uniform(1.5, 3.14);
  return {triangle, cone};
}

SensedTriangle large_triangle_nearby(Random& random) {
  Triangle triangle = any_triangle(random);
  SensingCone cone = any_cone(random);
  cone.apex = point_of(triangle, random) + std::pow(10, random.uniform(-6, -1)) * in_cube(random);
  return {triangle, cone};
}

SensedTriangle small_triangle_far_away(Random& random) {
  const Vector3d place = in_cube(random);
  Triangle triangle = any_triangle(random);
  const double size = std::pow(10, random.uniform(-9, -2));
  for (Vector3d& vertex : triangle)
    vertex = place + size * vertex;
  const Vector3d aimed = point_of(triangle, random);
  const double angle = random.uniform(0.5, 2) * size;
  return {triangle, cone_towards(in_cube(random), aimed, angle, random)};
}

SensedTriangle sliver(Random& random) {
  SensedTriangle result = generic(random);
  Triangle& triangle = result.triangle;
  const Vector3d width = std::pow(10, random.uniform(-15, -3)) * in_cube(random);
  triangle[2] = triangle[0] + random.uniform(0, 1) * (triangle[1] - triangle[0]) + width;
  return result;
}

/// Returns a triangle with exactly collinear vertices: two coincide, or one is the midpoint of the other two,
/// which have few digits.
SensedTriangle segment(Random& random) {
  SensedTriangle result = generic(random);
  Triangle& triangle = result.triangle;
  for (Vector3d& vertex : triangle)
    vertex = (0x1p20 * vertex).array().round() * 0x1p-20;
  triangle[2] = random.uniform(0, 1) < 0.5 ? triangle[0] : (triangle[0] + triangle[1]) / 2;
  return result;
}

SensedTriangle single_point(Random& random) {
  SensedTriangle result = generic(random);
  result.triangle[1] = result.triangle[2] = result.triangle[0];
  return result;
}

/// Returns a triangle whose plane is tangent to the cone up to a small angle.
SensedTriangle grazing_plane(Random& random) {
  const double half_angle = random.uniform(0.1, 1.4);
  const double off = std::pow(10, random.uniform(-13, -3)) * (random.uniform(0, 1) < 0.3 ? 1 : -1);
  const Vector3d normal(std::cos(half_angle + off), 0, -std::sin(half_angle + off));
  const Vector3d on_cone(std::sin(half_angle), 0, std::cos(half_angle)), across(0, 1, 0);
  const Vector3d foot = on_cone * random.uniform(0.5, 2);
  Triangle triangle{foot - 0.3 * on_cone - across, foot - 0.2 * on_cone + across, foot + on_cone};
  for (Vector3d& vertex : triangle)
    vertex -= vertex.dot(normal) * normal;
  return {triangle, {Vector3d::Zero(), {0, 0, 1}, 2 * half_angle, far_enough}};
}

/// Returns a triangle with an edge tangent to the cone up to a small angle and the rest outside.
SensedTriangle grazing_side(Random& random) {
  const double half_angle = random.uniform(0.1, 1.4);
  const double off = std::pow(10, random.uniform(-13, -3)) * (random.uniform(0, 1) < 0.3 ? 1 : -1);
  const Vector3d beside(std::sin(half_angle + off), 0, std::cos(half_angle + off)), outwards(1, 0, 0);
  const Vector3d along = Vector3d(0, 1, 0) + random.uniform(-2, 2) * beside;
  const Vector3d start = beside - random.uniform(0.1, 0.4) * along,
                 end = beside + random.uniform(0.1, 0.4) * along;
  return {{start, end, beside + 2 * outwards}, {Vector3d::Zero(), {0, 0, 1}, 2 * half_angle, far_enough}};
}

SensedTriangle far_from_origin(Random& random) {
  SensedTriangle result = generic(random);
  const Vector3d offset = 1000 * in_cube(random);
  for (Vector3d& vertex : result.triangle)
    vertex += offset;
  result.cone.apex += offset;
  return result;
}

SensedTriangle scaled(Random& random) {
  SensedTriangle result = generic(random);
  const int exponent = static_cast<int>(random.uniform(-900, 900));
  for (Vector3d& vertex : result.triangle)
    vertex *= std::ldexp(1, exponent);
  result.cone.apex *= std::ldexp(1, exponent);
  result.cone.range = std::ldexp(far_enough, exponent);
  result.cone.direction *= std::ldexp(1, static_cast<int>(random.uniform(-900, 900)));
  return result;
}

}  // namespace

std::vector<SensedClass> sensed_classes() {
  return {{"generic", generic},
          {"narrow", narrow},
          {"wide", wide},
          {"axis_parallel_to_plane", axis_parallel_to_plane},
          {"plane_behind", plane_behind},
          {"large_triangle_nearby", large_triangle_nearby},
          {"small_triangle_far_away", small_triangle_far_away},
          {"sliver", sliver},
          {"segment", segment},
          {"single_point", single_point},
          {"grazing_plane", grazing_plane},
          {"grazing_side", grazing_side},
          {"far_from_origin", far_from_origin},
          {"scaled", scaled}};
}

}  // namespace fringe::test
