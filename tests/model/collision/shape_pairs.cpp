#include "shape_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "collision/convex_pair.hpp"
#include "collision/minkowski_difference.hpp"

namespace fringe::test {
namespace {

using Eigen::Vector3d;

Vector3d direction(Random& random) {
  return random.in_box({-1, -1, -1}, {1, 1, 1}).normalized();
}

/// Returns 0, or a number of either sign with a magnitude from 1e-15 to 1e-3.
double small_gap(Random& random) {
  const std::size_t kind = below(random, 14);
  if (kind == 0)
    return 0;
  return std::pow(10.0, -static_cast<double>(kind) - 2) * (below(random, 2) == 0 ? 1 : -1);
}

double lowest_along(const Points& points, const Vector3d& axis) {
  return std::min_element(points.begin(), points.end(),
                          [&](const Vector3d& p, const Vector3d& q) { return p.dot(axis) < q.dot(axis); })
      ->dot(axis);
}

void move(Points& points, const Vector3d& offset) {
  for (Vector3d& point : points)
    point += offset;
}

Points cuboid(Random& random) {
  return corners_of_box(random.in_box({0.1, 0.1, 0.1}, {1, 1, 1}));
}

/// Returns two shapes whose extreme vertices along a direction face each other at the distance of the gap.
ShapePair apart_by_gap(Random& random) {
  ShapePair pair{any_shape(random, 12), any_shape(random, 12)};
  const Vector3d axis = direction(random);
  const auto is_lower = [&](const Vector3d& p, const Vector3d& q) { return p.dot(axis) < q.dot(axis); };
  const Vector3d& highest = *std::max_element(pair.a.begin(), pair.a.end(), is_lower);
  const Vector3d& lowest = *std::min_element(pair.b.begin(), pair.b.end(), is_lower);
  const Vector3d offset = highest - lowest + small_gap(random) * axis;
  move(pair.b, offset);
  return pair;
}

/// Returns two bodies, one with a vertex, edge or face at a face of the other, rotated together.
ShapePair at_a_face(Random& random) {
  ShapePair pair{cuboid(random), below(random, 2) == 0 ? cuboid(random) : any_shape(random, 10)};
  const Vector3d up = Vector3d::UnitZ();
  const double top = -lowest_along(pair.a, -up);
  const Vector3d aside = random.in_box({-1, -1, 0}, {1, 1, 0});
  move(pair.b, (top - lowest_along(pair.b, up) + small_gap(random)) * up + aside);
  const Eigen::Isometry3d motion = random.rigid_motion();
  return {moved(pair.a, motion), moved(pair.b, motion)};
}

/// Returns two long edges that cross at the distance of the gap.
ShapePair crossing_edges(Random& random) {
  const Vector3d u = direction(random), v = direction(random), normal = u.cross(v).normalized();
  const double gap = small_gap(random);
  Points a{u, -u * random.uniform(0.1, 1)}, b{v, -v * random.uniform(0.1, 1)};
  for (std::size_t i = below(random, 5); i > 0; --i)
    a.emplace_back(direction(random) - 2 * normal);
  for (std::size_t i = below(random, 5); i > 0; --i)
    b.emplace_back(direction(random) + 2 * normal);
  move(b, gap * normal);
  return {a, b};
}

/// Returns shapes with few different coordinates, so that points coincide, are collinear or coplanar, and
/// shapes touch exactly.
ShapePair on_a_grid(Random& random) {
  const auto shape = [&](double shift) {
    Points points;
    for (std::size_t i = 1 + below(random, 9); i > 0; --i)
      points.emplace_back(static_cast<double>(below(random, 3)) + shift,
                          static_cast<double>(below(random, 3)), static_cast<double>(below(random, 3)));
    return points;
  };
  const auto shift = static_cast<double>(below(random, 4));
  return {shape(0), shape(shift)};
}

ShapePair nested(Random& random) {
  Points outer = cuboid(random), inner = any_shape(random, 12);
  for (Vector3d& point : inner)
    point *= 0.05;
  return below(random, 2) == 0 ? ShapePair{outer, inner} : ShapePair{inner, outer};
}

ShapePair anywhere(Random& random) {
  ShapePair pair{any_shape(random, 12), any_shape(random, 12)};
  move(pair.b, random.uniform(0, 1.5) * direction(random));
  return pair;
}

/// Returns two flat shapes in one plane, up to rounding.
ShapePair coplanar(Random& random) {
  ShapePair pair = below(random, 2) == 0 ? apart_by_gap(random) : on_a_grid(random);
  for (Points* points : {&pair.a, &pair.b})
    for (Vector3d& point : *points)
      point.z() = 0;
  if (below(random, 2) == 0)
    return pair;
  const Eigen::Isometry3d motion = random.rigid_motion();
  return {moved(pair.a, motion), moved(pair.b, motion)};
}

/// Returns the same shape twice, the second one moved along one of its edges and by the gap.
ShapePair twins(Random& random) {
  const Points a = below(random, 2) == 0 ? cuboid(random) : any_shape(random, 12);
  Points b = a;
  const Vector3d edge = a[below(random, a.size())] - a[below(random, a.size())];
  const double share = below(random, 2) == 0 ? 1.0 : random.uniform(0, 1.2);
  move(b, share * edge + small_gap(random) * direction(random));
  return {a, b};
}

/// Returns shapes with coordinates of very different magnitudes.
ShapePair mixed_magnitudes(Random& random) {
  const auto shape = [&] {
    Points points;
    for (std::size_t i = 1 + below(random, 6); i > 0; --i) {
      Vector3d point = random.in_box({-1, -1, -1}, {1, 1, 1});
      for (double& coordinate : point)
        coordinate = std::ldexp(coordinate, -static_cast<int>(below(random, 120)));
      points.push_back(point);
    }
    return points;
  };
  const Points a = shape();
  return {a, shape()};
}

constexpr std::size_t class_count = 10;

}  // namespace

std::size_t below(Random& random, std::size_t limit) {
  return static_cast<std::size_t>(random.uniform(0, static_cast<double>(limit)));
}

Points any_shape(Random& random, std::size_t most) {
  const std::array<Vector3d, 3> spanning{direction(random), direction(random), direction(random)};
  const std::size_t dimension = below(random, 8) < 5 ? 3 : below(random, 3);
  const Vector3d centre = 0.3 * direction(random);
  Points points;
  for (std::size_t i = 1 + below(random, most); i > 0; --i) {
    Vector3d point = centre;
    for (std::size_t k = 0; k < dimension; ++k)
      point += random.uniform(-1, 1) * spanning[k];
    points.push_back(point);
  }
  return points;
}

Points corners_of_box(const Vector3d& half_widths) {
  Points corners;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        corners.emplace_back(half_widths.cwiseProduct(Vector3d(x, y, z)));
  return corners;
}

Points moved(const Points& points, const Eigen::Isometry3d& motion) {
  Points result;
  for (const Vector3d& point : points)
    result.push_back(motion * point);
  return result;
}

ShapePair placed(const ShapePair& pair, double factor, const Vector3d& offset) {
  ShapePair result = pair;
  for (Points* points : {&result.a, &result.b})
    for (Vector3d& point : *points)
      point = factor * point + offset;
  return result;
}

GjkDistance exact_distance(const Points& a, const Points& b) {
  const detail::PassingHulls hulls(a, b);
  const detail::ConvexPair pair = hulls.pair();
  const detail::PolytopeDifference difference(pair, detail::Goal::distance);
  return difference.distance(detail::gjk<detail::Dyadic>(difference, pair.start()));
}

std::span<const PairClass> pair_classes() {
  static const std::array<PairClass, class_count> classes{
      {{"anywhere", anywhere},
       {"apart_by_gap", apart_by_gap},
       {"at_a_face", at_a_face},
       {"coplanar", coplanar},
       {"crossing_edges", crossing_edges},
       {"mixed_magnitudes", mixed_magnitudes},
       {"nested", nested},
       {"on_a_grid", on_a_grid},
       {"one_kilometre_away",
        [](Random& random) {
          const ShapePair near = below(random, 2) == 0 ? at_a_face(random) : apart_by_gap(random);
          return placed(near, 1, {1000, -700, 300});
        }},
       {"twins", twins}}};
  return classes;
}

}  // namespace fringe::test
