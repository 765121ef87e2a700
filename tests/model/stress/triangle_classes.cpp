#include "triangle_classes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "../geometry.hpp"
#include "fringe/error.hpp"

namespace fringe::stress {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::Random;

/// Number of plates per class: many shapes and poses, and still enough triangles per plate to fill a batch.
constexpr std::size_t most_groups = 16;

/// Unit of length of which all coordinates are multiples where triangles must touch the plate exactly. Sums
/// and products with small integers then have no rounding error.
constexpr double grid = 0x1p-12;

double on_grid(double number) {
  return grid * std::round(number / grid);
}

Vector3d on_grid(const Vector3d& point) {
  return {on_grid(point.x()), on_grid(point.y()), on_grid(point.z())};
}

double log_uniform(Random& random, double low, double high) {
  return std::pow(10.0, random.uniform(std::log10(low), std::log10(high)));
}

bool chance(Random& random, double probability) {
  return random.uniform(0, 1) < probability;
}

Vector3d direction(Random& random) {
  while (true) {
    const Vector3d vector = random.in_box({-1, -1, -1}, {1, 1, 1});
    if (vector.norm() > 0.1 && vector.norm() < 1)
      return vector.normalized();
  }
}

/// A plate's side lengths in the coordinates of a generator of triangles: the plate is 0 ≤ x ≤ length.x, 0 ≤
/// y ≤ length.y.
struct Size {
  Vector2d length;

  double scale() const { return length.maxCoeff(); }
  Vector3d extent() const { return {length.x(), length.y(), 0}; }
};

/// Draws a triangle for a plate whose axes x and y may be exchanged and each measured from its opposite end,
/// so that a generator only has to consider the edge x = 0.
template <Triangle (*draw)(Random&, const Size&)>
Triangle at_any_side(Random& random, const Size& size) {
  const bool exchanged = chance(random, 0.5), flip_x = chance(random, 0.5), flip_y = chance(random, 0.5);
  Triangle triangle = draw(random, exchanged ? Size{{size.length.y(), size.length.x()}} : size);
  for (Vector3d& vertex : triangle) {
    if (exchanged)
      std::swap(vertex.x(), vertex.y());
    if (flip_x)
      vertex.x() = size.length.x() - vertex.x();
    if (flip_y)
      vertex.y() = size.length.y() - vertex.y();
  }
  return triangle;
}

/// Returns a random point around the plate, at a height in a range given in plate sizes.
Vector3d around(Random& random, const Size& size, double lowest = 0.1, double highest = 1.5) {
  const double scale = size.scale();
  return random.in_box(Vector3d(-1.5, -1.5, lowest) * scale,
                       size.extent() + Vector3d(1.5, 1.5, highest) * scale);
}

Triangle triangle_around(Random& random, const Size& size, double lowest = 0.1, double highest = 1.5) {
  const Vector3d a = around(random, size, lowest, highest), b = around(random, size, lowest, highest);
  return {a, b, around(random, size, lowest, highest)};
}

/// Returns whether the area is at least a twentieth of the longest edge squared.
bool well_shaped(const Triangle& triangle) {
  const double longest =
      std::max({(triangle[1] - triangle[0]).squaredNorm(), (triangle[2] - triangle[1]).squaredNorm(),
                (triangle[0] - triangle[2]).squaredNorm()});
  return fringe::twice_area(triangle) >= 0.1 * longest;
}

/// Draws triangles until one is well shaped.
template <class Draw>
Triangle shaped(const Draw& draw) {
  while (true) {
    Triangle triangle = draw();
    if (well_shaped(triangle))
      return triangle;
  }
}

Triangle in_box(Random& random, const Vector3d& low, const Vector3d& high) {
  return shaped([&] { return random.triangle_in_box(low, high); });
}

Triangle ordinary(Random& random, const Size& size) {
  return shaped([&] { return triangle_around(random, size); });
}

Triangle in_region_1(Random& random, const Size& size) {
  const double scale = size.scale();
  return in_box(random, 0.01 * size.extent() + Vector3d(0, 0, 0.05 * scale),
                0.99 * size.extent() + Vector3d(0, 0, scale));
}

Triangle in_region_2(Random& random, const Size& size) {
  const double scale = size.scale();
  return in_box(random, {-scale, 0.01 * size.length.y(), 0.05 * scale},
                {-0.01 * scale, 0.99 * size.length.y(), scale});
}

Triangle in_region_3(Random& random, const Size& size) {
  const double scale = size.scale();
  return in_box(random, {-scale, -scale, 0.05 * scale}, {-0.01 * scale, -0.01 * scale, scale});
}

/// Returns a triangle around the plate's centre, with a part in each of the nine cells.
Triangle in_nine_cells(Random& random, const Size& size) {
  const double scale = size.scale();
  const double start = random.uniform(0, 2 * std::numbers::pi);
  Triangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle =
        start + 2 * std::numbers::pi / 3 * (static_cast<double>(i) + random.uniform(-0.2, 0.2));
    const double radius = random.uniform(4, 8) * scale;
    triangle[i] = size.extent() / 2 + Vector3d(radius * std::cos(angle), radius * std::sin(angle),
                                               random.uniform(0.1, 2) * scale);
  }
  return triangle;
}

Triangle sliver(Random& random, const Size& size) {
  const Vector3d a = around(random, size), b = around(random, size);
  const Vector3d across = (b - a).cross(direction(random)) / log_uniform(random, 1, 1e10);
  return {a, b, a + random.uniform(0, 1) * (b - a) + across};
}

/// Returns a triangle in a plane of slope `tilt` whose height above the plate's centre is at least 0.4 plate
/// sizes; half of these triangles lie in front of the plate.
Triangle tilted(Random& random, const Size& size, double tilt) {
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  const Vector2d slope(tilt * std::cos(angle), tilt * std::sin(angle));
  const double height = random.uniform(0.4, 1.5) * size.scale();
  const bool in_front = chance(random, 0.5);
  return shaped([&] {
    Triangle triangle = in_front ? random.triangle_in_box(0.01 * size.extent(), 0.99 * size.extent())
                                 : triangle_around(random, size);
    for (Vector3d& vertex : triangle)
      vertex.z() = height + slope.dot(vertex.head<2>() - size.length / 2);
    return triangle;
  });
}

Triangle parallel(Random& random, const Size& size) {
  return tilted(random, size, 0);
}

Triangle nearly_parallel(Random& random, const Size& size) {
  return tilted(random, size, log_uniform(random, 1e-16, 1e-1));
}

double small_distance(Random& random, const Size& size) {
  return size.scale() * log_uniform(random, 1e-12, 1e-1);
}

Vector3d on_plate(Random& random, const Size& size) {
  return random.in_box(0.05 * size.extent(), 0.95 * size.extent());
}

Vector3d on_edge(Random& random, const Size& size) {
  return {0, random.uniform(0.05, 0.95) * size.length.y(), 0};
}

Triangle with_vertex(Random& random, const Size& size, const Vector3d& vertex) {
  return {vertex, around(random, size), around(random, size)};
}

Triangle near_plate(Random& random, const Size& size) {
  const Vector3d foot = on_plate(random, size);
  return with_vertex(random, size, foot + Vector3d(0, 0, small_distance(random, size)));
}

Triangle near_edge(Random& random, const Size& size) {
  const double angle = random.uniform(0, std::numbers::pi);
  const Vector3d foot = on_edge(random, size);
  const Vector3d vertex = foot + small_distance(random, size) * Vector3d(std::cos(angle), 0, std::sin(angle));
  return with_vertex(random, size, vertex);
}

Triangle near_corner(Random& random, const Size& size) {
  Vector3d outwards = direction(random);
  outwards.z() = std::abs(outwards.z());
  return with_vertex(random, size, small_distance(random, size) * outwards);
}

/// Returns a random point beside the plate (x < 0), in front of its plane or behind it.
Vector3d beside(Random& random, const Size& size) {
  const double scale = size.scale();
  return random.in_box({-scale, -scale, -scale}, {-0.01 * scale, size.length.y() + scale, scale});
}

/// Returns a triangle that touches the plate with one vertex only: the other two vertices lie both in front
/// of the plate's plane, or both beside the border plane that contains the vertex.
Triangle touching_with_vertex(Random& random, const Size& size, const Vector3d& vertex, bool allow_beside) {
  Triangle triangle{on_grid(vertex), {}, {}};
  const bool in_front = !allow_beside || chance(random, 0.5);
  for (std::size_t i = 1; i < 3; ++i)
    triangle[i] = on_grid(in_front ? around(random, size) : beside(random, size));
  return triangle;
}

Triangle touching_plate(Random& random, const Size& size) {
  return touching_with_vertex(random, size, on_plate(random, size), false);
}

Triangle touching_edge(Random& random, const Size& size) {
  return touching_with_vertex(random, size, on_edge(random, size), true);
}

Triangle touching_corner(Random& random, const Size& size) {
  return touching_with_vertex(random, size, {0, 0, 0}, true);
}

/// Returns a triangle with an edge in the plane x = −gap that passes the plate's edge or corner, and the
/// third vertex farther out.
Triangle passing_with_edge(Random& random, const Size& size, double gap) {
  const Vector3d foot = chance(random, 0.5) ? Vector3d::Zero() : on_grid(on_edge(random, size));
  // Even multiples of the grid, so that the half is on the grid as well.
  Vector3d along = 2 * on_grid(0.5 * random.in_box({0, -1, 0.1}, {0, 1, 1}) * size.scale());
  if (chance(random, 0.5))
    along = -along;
  const Vector3d shift(-gap, 0, 0);
  return {foot + along + shift, foot - along / 2 + shift, on_grid(beside(random, size)) + shift};
}

Triangle touching_with_edge(Random& random, const Size& size) {
  return passing_with_edge(random, size, 0);
}

/// Returns a triangle perpendicular to a direction that points away from the corner, at the distance `gap`.
Triangle passing_with_face(Random& random, const Size& size, double gap) {
  const Vector3d outwards =
      Vector3d(random.uniform(-1, -0.1), random.uniform(-1, -0.1), random.uniform(-1, 1)).normalized();
  const Vector3d across = outwards.cross(direction(random)).normalized(), up = outwards.cross(across);
  const double start = random.uniform(0, 2 * std::numbers::pi);
  Triangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = start + 2 * std::numbers::pi / 3 * static_cast<double>(i);
    const double radius = random.uniform(0.2, 1) * size.scale();
    triangle[i] = gap * outwards + radius * (std::cos(angle) * across + std::sin(angle) * up);
  }
  return triangle;
}

Triangle passing_closely(Random& random, const Size& size) {
  const double gap = small_distance(random, size);
  return chance(random, 0.5) ? passing_with_edge(random, size, gap) : passing_with_face(random, size, gap);
}

/// Returns a random triangle of a given size about a point.
Triangle about(Random& random, const Vector3d& middle, double size) {
  return shaped([&] {
    Triangle triangle = random.triangle_in_box(Vector3d::Constant(-size / 2), Vector3d::Constant(size / 2));
    for (Vector3d& vertex : triangle)
      vertex += middle;
    return triangle;
  });
}

Triangle far(Random& random, const Size& size) {
  return about(random, 1e4 * size.scale() * direction(random), size.scale());
}

Triangle micrometre(Random& random, const Size& size) {
  constexpr double side = 1e-6;
  Vector3d middle = around(random, size);
  middle.z() = side + size.scale() * log_uniform(random, 1e-5, 1);
  return about(random, middle, side);
}

Triangle huge(Random& random, const Size& size) {
  constexpr double plate_sizes = 1e4;
  const double lateral = plate_sizes * size.scale();
  const double lowest = 0.1 * size.scale(), highest = chance(random, 0.5) ? size.scale() : lateral;
  return in_box(random, {-lateral, -lateral, lowest}, {lateral, lateral, highest});
}

Triangle in_the_plane(Random& random, const Size& size) {
  return shaped([&] {
    Triangle triangle;
    for (Vector3d& vertex : triangle) {
      vertex = beside(random, size) - Vector3d(0.04 * size.scale(), 0, 0);
      vertex.z() = 0;
    }
    return triangle;
  });
}

Triangle edge_in_border_plane(Random& random, const Size& size) {
  return shaped([&] {
    Triangle triangle = triangle_around(random, size);
    triangle[0].x() = triangle[1].x() = 0;
    return triangle;
  });
}

Triangle in_border_plane(Random& random, const Size& size) {
  return shaped([&] {
    Triangle triangle = triangle_around(random, size);
    for (Vector3d& vertex : triangle)
      vertex.x() = 0;
    return triangle;
  });
}

Triangle plane_through_corner(Random& random, const Size& size) {
  return shaped([&] {
    const Vector3d low(-1, -1, 0.1), high(-0.1, -0.1, 1);
    const Vector3d u = size.scale() * random.in_box(low, high), v = size.scale() * random.in_box(low, high);
    Triangle triangle;
    for (Vector3d& vertex : triangle)
      vertex = random.uniform(0.1, 1) * u + random.uniform(0.1, 1) * v;
    return triangle;
  });
}

Triangle plane_through_edge(Random& random, const Size& size) {
  return shaped([&] {
    const double angle = random.uniform(0, std::numbers::pi / 2);
    Triangle triangle;
    for (Vector3d& vertex : triangle) {
      const double radius = random.uniform(0.1, 1) * size.scale();
      vertex = {-radius * std::cos(angle), random.uniform(0.01, 0.99) * size.length.y(),
                radius * std::sin(angle)};
    }
    return triangle;
  });
}

/// Returns a triangle in a plane through the plate's edge, with two vertices at distances from the edge down
/// to 1e-18 of the plate's size. The plane is mostly a border plane or the plate's plane, where the vectors
/// from the plate are collinear.
Triangle edge_next_to_edge(Random& random, const Size& size) {
  const std::array directions{Vector3d(0, 0, 1), Vector3d(-1, 0, 0), Vector3d(-0.6, 0, 0.8)};
  const Vector3d& outwards = directions[static_cast<std::size_t>(random.uniform(0, 3))];
  const double gap = size.scale() * log_uniform(random, 1e-18, 1e-3);
  const auto at = [&](double radius) -> Vector3d {
    return Vector3d(0, on_grid(random.uniform(-0.5, 1.5) * size.length.y()), 0) + radius * outwards;
  };
  return shaped([&] {
    return Triangle{at(gap), at(random.uniform(0.5, 2) * gap), at(random.uniform(0.1, 1) * size.scale())};
  });
}

Triangle without_area(Random& random, const Size& size) {
  const Vector3d a = on_grid(around(random, size, -1, 1));
  if (chance(random, 0.1))
    return {a, a, a};
  const Vector3d step = on_grid(0.2 * around(random, size, -1, 1));
  const auto multiple = [&] { return std::round(random.uniform(-8, 8)); };
  return {a, a + multiple() * step, a + multiple() * step};
}

/// Returns a triangle whose centroid lies inside the plate and whose vertices lie on both sides of it.
Triangle crossing(Random& random, const Size& size) {
  const Vector3d middle = on_plate(random, size);
  const Vector3d up = size.scale() * random.in_box({-1, -1, 0.1}, {1, 1, 1});
  const Vector3d level = size.scale() * random.in_box({-1, -1, -0.05}, {1, 1, 0.05});
  return {middle + up, middle + level, middle - up - level};
}

/// Returns a triangle that meets the plate along a segment or in an area.
Triangle on_the_plate(Random& random, const Size& size) {
  const Vector3d a = on_grid(on_plate(random, size)), b = on_grid(on_plate(random, size));
  const Vector3d off = on_grid(around(random, size));
  const Vector3d level(off.x(), off.y(), 0);
  const auto beyond_end = [&](double start) {
    return on_grid(start + random.uniform(0.1, 1) * size.scale());
  };
  switch (static_cast<int>(random.uniform(0, 4))) {
  case 0:
    return {a, b, level};  // lies on the plate, at least in part
  case 1:
    return {a, b, off};  // an edge on the plate
  case 2:
    return {Vector3d(0, -beyond_end(0), 0), {0, beyond_end(size.length.y()), 0}, off};  // along its edge
  default:
    return {a, level, off};  // an edge that leaves the plate
  }
}

Triangle behind(Random& random, const Size& size) {
  return shaped([&] { return triangle_around(random, size, -1.5, -0.1); });
}

/// How a plate and its triangles are placed in the world.
enum class Placement { free, exact, at_origin, kilometre };

struct Kind {
  TriangleClass described;
  Placement placement;
  Triangle (*draw)(Random&, const Size&);
};

constexpr bool well_behaved = true, hard = false;

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {{"random", well_behaved}, Placement::free, ordinary},
      {{"region-1", well_behaved}, Placement::free, in_region_1},
      {{"region-2", well_behaved}, Placement::free, at_any_side<in_region_2>},
      {{"region-3", well_behaved}, Placement::free, at_any_side<in_region_3>},
      {{"nine-cells", well_behaved}, Placement::free, in_nine_cells},
      {{"behind", well_behaved}, Placement::free, behind},
      {{"sliver", hard}, Placement::free, sliver},
      {{"parallel", well_behaved}, Placement::free, parallel},
      {{"nearly-parallel", well_behaved}, Placement::free, nearly_parallel},
      {{"near-plate", hard}, Placement::free, near_plate},
      {{"near-edge", hard}, Placement::free, at_any_side<near_edge>},
      {{"near-corner", hard}, Placement::free, at_any_side<near_corner>},
      {{"passing-closely", hard}, Placement::free, at_any_side<passing_closely>},
      {{"touching-plate", hard}, Placement::exact, touching_plate},
      {{"touching-edge", hard}, Placement::exact, at_any_side<touching_edge>},
      {{"touching-corner", hard}, Placement::exact, at_any_side<touching_corner>},
      {{"touching-with-edge", hard}, Placement::exact, at_any_side<touching_with_edge>},
      {{"far", hard}, Placement::free, far},
      {{"one-kilometre-away", hard}, Placement::kilometre, ordinary},
      {{"one-micrometre", hard}, Placement::free, micrometre},
      {{"huge", hard}, Placement::free, huge},
      {{"in-the-plane", well_behaved}, Placement::free, at_any_side<in_the_plane>},
      {{"edge-in-border-plane", well_behaved}, Placement::free, at_any_side<edge_in_border_plane>},
      {{"in-border-plane", well_behaved}, Placement::free, at_any_side<in_border_plane>},
      {{"plane-through-corner", well_behaved}, Placement::free, at_any_side<plane_through_corner>},
      {{"plane-through-edge", well_behaved}, Placement::free, at_any_side<plane_through_edge>},
      {{"edge-next-to-edge", hard}, Placement::at_origin, edge_next_to_edge},
      {{"no-area", hard}, Placement::exact, without_area},
      {{"crossing", hard}, Placement::free, crossing},
      {{"on-the-plate", hard}, Placement::exact, at_any_side<on_the_plate>},
  };
  return all;
}

/// Returns a rotation by multiples of 90° about the axes, which rounds no coordinate.
Eigen::Matrix3d quarter_turns(Random& random) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (int axis = 0; axis < 3; ++axis)
    for (int turns = static_cast<int>(random.uniform(0, 4)); turns > 0; --turns) {
      Eigen::Matrix3d quarter = Eigen::Matrix3d::Zero();
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      quarter(axis, axis) = 1;
      quarter(last, next) = 1;
      quarter(next, last) = -1;
      turn = quarter * turn;
    }
  return turn;
}

Eigen::Isometry3d placement(Random& random, Placement kind, double scale) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (kind == Placement::exact || kind == Placement::at_origin) {
    pose.linear() = quarter_turns(random);
    if (kind == Placement::exact)
      pose.translation() = on_grid(random.in_box({-4, -4, -4}, {4, 4, 4}));
    return pose;
  }
  pose.linear() = random.rigid_motion().linear();
  pose.translation() = kind == Placement::kilometre
                           ? Vector3d(1000 * direction(random))
                           : Vector3d(scale * random.in_box({-1, -1, -1}, {1, 1, 1}));
  return pose;
}

/// Returns random side lengths from 5 cm to 2 m.
Size plate_size(Random& random, Placement kind) {
  const Vector2d length(log_uniform(random, 0.05, 2), log_uniform(random, 0.05, 2));
  return kind == Placement::exact || kind == Placement::at_origin
             ? Size{{on_grid(length.x()), on_grid(length.y())}}
             : Size{length};
}

Group make_group(Random& random, const Kind& kind, std::size_t count, bool moved) {
  const Size size = plate_size(random, kind.placement);
  const Eigen::Isometry3d pose = moved || kind.placement == Placement::kilometre
                                     ? placement(random, kind.placement, size.scale())
                                     : Eigen::Isometry3d::Identity();
  Group group{{pose.translation(), pose.linear() * Vector3d(size.length.x(), 0, 0),
               pose.linear() * Vector3d(0, size.length.y(), 0)},
              {}};
  group.triangles.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle local = kind.draw(random, size);
    group.triangles.push_back({pose * local[0], pose * local[1], pose * local[2]});
  }
  return group;
}

}  // namespace

std::vector<TriangleClass> triangle_classes() {
  std::vector<TriangleClass> all;
  for (const Kind& kind : kinds())
    all.push_back(kind.described);
  return all;
}

std::vector<Group> make_triangles(const std::string& name, std::size_t count, std::uint64_t seed) {
  const auto kind =
      std::find_if(kinds().begin(), kinds().end(), [&](const Kind& k) { return k.described.name == name; });
  if (kind == kinds().end())
    throw InputError(fmt::format("there is no class '{}'", name));
  // Every class has its own sequence of random numbers, whichever other classes are run.
  Random random(seed * kinds().size() + static_cast<std::uint64_t>(kind - kinds().begin()));
  std::vector<Group> groups;
  const std::size_t group_count = std::min(most_groups, count);
  for (std::size_t i = 0; i < group_count; ++i)
    groups.push_back(
        make_group(random, *kind, count * (i + 1) / group_count - count * i / group_count, i % 2 == 1));
  return groups;
}

}  // namespace fringe::stress
