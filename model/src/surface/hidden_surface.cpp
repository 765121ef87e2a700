#include "surface/hidden_surface.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "fringe/gjk.hpp"
#include "geometry/surface_mesh.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Tests whether two boxes touch or overlap, up to rounding.
bool touch(const AlignedBox3d& a, const AlignedBox3d& b) {
  const double tolerance = touching_surfaces * std::max(a.diagonal().norm(), b.diagonal().norm());
  return a.squaredExteriorDistance(b) <= tolerance * tolerance;
}

/// Returns a triangle shrunk a little about its centre and moved a little off its plane, on one side.
Triangle beside(const Triangle& triangle, double side) {
  /// Part of the way from the corners to the centre: it keeps adjacent triangles off.
  constexpr double shrinking = 1e-3;
  /// Distance from the plane, relative to the triangle's size; above rounding, below any feature.
  constexpr double shift = 1e-5;
  const Vector3d centre = centre_of(triangle), normal = unit_normal(triangle);
  const double size = std::sqrt(twice_area(triangle));
  Triangle result;
  for (std::size_t k = 0; k < 3; ++k)
    result[k] = triangle[k] + shrinking * (centre - triangle[k]) + side * shift * size * normal;
  return result;
}

}  // namespace

HiddenSurface::HiddenSurface(const ChargedBodies& bodies)
    : bodies_(bodies.bodies.size()), around_(bodies.bodies.size()) {
  std::vector<std::size_t> shell_counts(bodies_.size(), 0);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    check_interruption();
    const auto triangles = triangles_of(bodies.bodies[k].surface);
    if (triangles.empty())
      continue;
    Body& body = bodies_[k];
    body.is_target = bodies.bodies[k].is_target;
    body.is_round = round_shape_of(bodies.bodies[k].surface) != nullptr;
    body.triangles.assign(triangles.begin(), triangles.end());
    const std::vector<std::uint32_t> shells = SurfaceMesh(body.triangles).shells();
    shell_counts[k] = 1 + *std::max_element(shells.begin(), shells.end());
    std::vector<std::vector<Triangle>> parts(shell_counts[k]);
    for (std::size_t triangle = 0; triangle < triangles.size(); ++triangle)
      parts[shells[triangle]].push_back(triangles[triangle]);
    for (const std::vector<Triangle>& part : parts)
      if (fringe::is_closed(part))
        body.closed.insert(body.closed.end(), part.begin(), part.end());
    std::vector<AlignedBox3d> boxes;
    for (const Triangle& triangle : body.closed)
      boxes.push_back(axis_aligned_box(triangle));
    body.boxes = BoxTree(boxes);
    body.box = axis_aligned_box(body.closed);
  }
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    bool is_alone = true;
    for (std::size_t other = 0; other < bodies_.size(); ++other) {
      const bool is_one_conductor = bodies.bodies[k].conductor == bodies.bodies[other].conductor;
      // Without the targets, what they cover is bare.
      const bool comes_and_goes = bodies.bodies[other].is_target && !bodies.bodies[k].is_target;
      if (k == other || !is_one_conductor || comes_and_goes || bodies_[k].triangles.empty() ||
          bodies_[other].closed.empty() || !touch(axis_aligned_box(bodies_[k].triangles), bodies_[other].box))
        continue;
      around_[k].push_back(other);
      is_alone = false;
    }
    if (!bodies_[k].closed.empty() && (!is_alone || shell_counts[k] > 1))
      around_[k].push_back(k);
  }
}

/// Returns where a triangle is that does not cross the body's surface.
HiddenSurface::Place HiddenSurface::place(const Triangle& shifted, const Body& body) {
  const AlignedBox3d box = axis_aligned_box(shifted);
  if (!body.box.intersects(box))
    return Place::outside;
  bool crosses = false;
  body.boxes.for_each(
      box, [&](std::uint32_t k) { crosses = crosses || gjk_intersects(shifted, body.closed[k]).intersects; });
  if (crosses)
    return Place::unknown;
  return is_in_polyhedron(body.closed, centre_of(shifted)) ? Place::inside : Place::outside;
}

/// Returns where the outer and the inner side of a part of a surface are, seen from a body.
std::array<HiddenSurface::Place, 2> HiddenSurface::places(const std::array<Triangle, 2>& sides,
                                                          std::size_t of, std::size_t body) const {
  // Parts of a hollow wall move into the polyhedron that stands for their body, but stay its surface.
  if (of == body && bodies_[body].is_round)
    return {Place::outside, Place::inside};
  return {place(sides[0], bodies_[body]), place(sides[1], bodies_[body])};
}

bool HiddenSurface::contains(const Triangle& part, std::size_t body) const {
  if (around_[body].empty())
    return false;
  check_interruption();
  const std::array<Triangle, 2> sides{beside(part, 1), beside(part, -1)};
  std::array<bool, 2> is_inside{false, false};
  for (const std::size_t k : around_[body]) {
    const auto [one, other] = places(sides, body, k);
    is_inside[0] = is_inside[0] || one == Place::inside;
    is_inside[1] = is_inside[1] || other == Place::inside;
    if (is_inside[0] && is_inside[1])
      return true;
    const bool lies_on = (one == Place::inside && other == Place::outside) ||
                         (one == Place::outside && other == Place::inside);
    // Of two bodies whose surfaces lie on each other, the later one leaves out its part; a body without
    // closed shells, on which nothing lies, always does, and so does a target on what is none.
    if (lies_on && k != body &&
        (k < body || bodies_[body].closed.empty() || bodies_[body].is_target != bodies_[k].is_target))
      return true;
  }
  return false;
}

}  // namespace fringe::detail
