#include "surface/contact.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "collision/convex_pieces.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/surface_mesh.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// The vertices of a convex part of a body.
using ConvexHull = std::vector<Vector3d>;

/// Returns the convex parts of a body: the hull of all faces, or the triangles.
std::vector<ConvexHull> hulls_of(const BodySurface& surface) {
  std::vector<ConvexHull> hulls;
  if (const auto faces = faces_of(surface); !faces.empty()) {
    ConvexHull& hull = hulls.emplace_back();
    for (const ChargedFace& face : faces)
      for (const Vector3d& corner : corners_of(face))
        hull.push_back(corner);
  }
  for (const Triangle& triangle : triangles_of(surface))
    hulls.emplace_back(triangle.begin(), triangle.end());
  return hulls;
}

std::vector<AlignedBox3d> boxes_of(std::span<const ConvexHull> hulls) {
  std::vector<AlignedBox3d> boxes;
  boxes.reserve(hulls.size());
  for (const ConvexHull& hull : hulls)
    boxes.push_back(axis_aligned_box(hull));
  return boxes;
}

/// Returns true if any part of one body is no farther than `tolerance` from any part of the other. Without a
/// tolerance the test is exact.
bool hulls_meet(std::span<const ConvexHull> a, std::span<const ConvexHull> b, double tolerance) {
  const BoxTree tree(boxes_of(b));
  bool is_any_met = false;
  for (std::size_t k = 0; k < a.size() && !is_any_met; ++k) {
    check_interruption();
    AlignedBox3d box = axis_aligned_box(a[k]);
    // Rounding of the widened box must leave out none that is as far as the tolerance.
    const Vector3d wider = Vector3d::Constant(2 * tolerance);
    box = AlignedBox3d(box.min() - wider, box.max() + wider);
    tree.for_each(box, [&](std::size_t l) {
      is_any_met = is_any_met || gjk_intersects(a[k], b[l]).intersects ||
                   (tolerance > 0 && gjk_distance(a[k], b[l]).distance <= tolerance);
    });
  }
  return is_any_met;
}

/// Returns the hulls that have a point in common with a box.
std::vector<ConvexPiece> pieces_in(const AlignedBox3d& box, std::span<const ConvexHull> hulls) {
  std::vector<ConvexPiece> pieces;
  for (const ConvexHull& hull : hulls)
    if (axis_aligned_box(hull).intersects(box))
      pieces.push_back({ConvexShape::hull(hull)});
  return pieces;
}

/// Returns true if two bodies meet of which one at least is round: as shapes, not as the polyhedra that stand
/// for them and lie within.
bool round_shapes_meet(const ChargedBody& a, std::span<const ConvexHull> hulls_a, const ChargedBody& b,
                       std::span<const ConvexHull> hulls_b) {
  const RoundShape *const round_a = round_shape_of(a.surface), *const round_b = round_shape_of(b.surface);
  if (round_a == nullptr)
    return round_b != nullptr && round_shapes_meet(b, hulls_b, a, hulls_a);
  const std::vector<ConvexPiece> others =
      round_b != nullptr ? round_b->pieces() : pieces_in(round_a->box(), hulls_b);
  if (others.empty())
    return false;
  for (const ConvexPiece& piece : round_a->pieces())
    for (const ConvexPiece& other : others)
      if (intersect(piece.shape, piece.pose, other.shape, other.pose))
        return true;
  return false;
}

/// Returns true if a closed surface of triangles contains a body that does not cross it.
bool contains(const ChargedBody& outside, std::span<const ConvexHull> inside) {
  const auto surface = triangles_of(outside.surface);
  const Vector3d& point = inside.front().front();
  check_interruption();
  return axis_aligned_box(surface).contains(point) && is_closed(surface) && is_in_polyhedron(surface, point);
}

double size_of(std::span<const ConvexHull> hulls) {
  AlignedBox3d all;
  for (const ConvexHull& hull : hulls)
    all.extend(axis_aligned_box(hull));
  return all.diagonal().norm();
}

bool are_in_contact(const ChargedBody& a, std::span<const ConvexHull> hulls_a, const ChargedBody& b,
                    std::span<const ConvexHull> hulls_b) {
  const double tolerance = touching_surfaces * std::max(size_of(hulls_a), size_of(hulls_b));
  return hulls_meet(hulls_a, hulls_b, tolerance) || contains(a, hulls_b) || contains(b, hulls_a);
}

/// Tells how far a plate would have to be moved along its normal to leave a body; empty for another surface.
std::string way_off(const ChargedBody& plate, std::span<const ConvexHull> body) {
  const auto* surface = std::get_if<FlatPlate>(&plate.surface);
  if (surface == nullptr)
    return "";
  const ChargedFace& face = surface->face;
  const Vector3d normal = face.axis_u.cross(face.axis_v);
  double above = 0, below = 0;
  for (const ConvexHull& hull : body)
    for (const Vector3d& point : hull) {
      const double height = normal.dot(point - face.centre);
      above = std::max(above, height);
      below = std::max(below, -height);
    }
  const Vector3d direction = above <= below ? normal : -normal;
  return fmt::format("; {} is clear of it when moved by more than {:.3g} m along ({:.3g}, {:.3g}, {:.3g})",
                     plate.name, std::min(above, below), direction.x() + 0.0, direction.y() + 0.0,
                     direction.z() + 0.0);
}

}  // namespace

TriangleSurface oriented_triangles(const BodySurface& surface) {
  TriangleSurface result = triangulated(surface);
  const auto* box = std::get_if<BoxSurface>(&surface);
  if (box == nullptr)
    return result;
  const Vector3d centre = (box->faces[0].centre + box->faces[1].centre) / 2;
  for (Triangle& triangle : result.triangles)
    if ((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).dot(triangle[0] - centre) < 0)
      std::swap(triangle[1], triangle[2]);
  return result;
}

void refuse_contact(const ChargedBody& a, const ChargedBody& b, std::string_view reason) {
  const std::vector<ConvexHull> hulls_a = hulls_of(a.surface), hulls_b = hulls_of(b.surface);
  const auto refuse = [&] {
    throw InputError(
        fmt::format("{} and {} touch or cross: {}{}", a.name, b.name, reason, way_off(a, hulls_b)));
  };
  if (hulls_meet(hulls_a, hulls_b, 0))
    refuse();
  for (const auto& [outside, inside, points] : {std::tuple(&a, &b, &hulls_b), std::tuple(&b, &a, &hulls_a)})
    if (contains(*outside, *points))
      throw InputError(fmt::format("{} is inside {}: {}", inside->name, outside->name, reason));
  if (round_shapes_meet(a, hulls_a, b, hulls_b))
    refuse();
}

bool have_one_potential(const ChargedBodies& bodies, std::size_t a, std::size_t b) {
  const ChargedBody &one = bodies.bodies[a], &other = bodies.bodies[b];
  return one.conductor == other.conductor ||
         (bodies.role(one) == Role::grounded && bodies.role(other) == Role::grounded);
}

bool are_in_contact(const ChargedBody& a, const ChargedBody& b) {
  return are_in_contact(a, hulls_of(a.surface), b, hulls_of(b.surface));
}

std::vector<Contact> contacts_at_one_potential(const ChargedBodies& bodies) {
  std::vector<std::vector<ConvexHull>> hulls;
  for (const ChargedBody& body : bodies.bodies)
    hulls.push_back(hulls_of(body.surface));
  std::vector<Contact> contacts;
  for (std::size_t a = 0; a < hulls.size(); ++a)
    for (std::size_t b = a + 1; b < hulls.size(); ++b)
      if (have_one_potential(bodies, a, b) &&
          are_in_contact(bodies.bodies[a], hulls[a], bodies.bodies[b], hulls[b]))
        contacts.push_back({a, b});
  return contacts;
}

ChargedBodies joined(ChargedBodies bodies, const std::vector<Contact>& contacts) {
  // The conductor that each conductor becomes a part of: the first one.
  std::vector<std::size_t> joined_to(bodies.conductors.size());
  std::iota(joined_to.begin(), joined_to.end(), std::size_t{0});
  const auto root = [&](std::size_t conductor) {
    while (joined_to[conductor] != conductor)
      conductor = joined_to[conductor];
    return conductor;
  };
  std::vector<bool> touches(bodies.bodies.size(), false);
  for (const auto& [a, b] : contacts) {
    touches[a] = touches[b] = true;
    const std::size_t root_a = root(bodies.bodies[a].conductor), root_b = root(bodies.bodies[b].conductor);
    joined_to[std::max(root_a, root_b)] = std::min(root_a, root_b);
  }
  ChargedBodies result;
  std::vector<std::size_t> place(bodies.conductors.size());
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
    const ChargedConductor& conductor = bodies.conductors[k];
    const std::size_t first = root(k);
    place[k] = first == k ? result.conductors.size() : place[first];
    if (first == k)
      result.conductors.push_back(
          {conductor.name, conductor.role, {}, conductor.is_named, conductor.is_asked, conductor.to_ground});
    else if (ChargedConductor& whole = result.conductors[place[k]]; conductor.is_named && !whole.is_named) {
      whole.name = conductor.name;
      whole.is_named = true;
    }
  }
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k) {
    ChargedBody& body = bodies.bodies[k];
    std::vector<std::string>& members = result.conductors[place[body.conductor]].members;
    const std::string& name = bodies.conductors[body.conductor].members[body.member];
    const auto known = std::find(members.begin(), members.end(), name);
    body.member = static_cast<std::size_t>(known - members.begin());
    if (known == members.end())
      members.push_back(name);
    body.conductor = place[body.conductor];
    if (touches[k])
      body.surface = oriented_triangles(body.surface);
    result.bodies.push_back(std::move(body));
  }
  return result;
}

ChargedBodies joined(ChargedBodies bodies) {
  for (std::size_t a = 0; a < bodies.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.bodies.size(); ++b)
      if (!have_one_potential(bodies, a, b))
        refuse_contact(bodies.bodies[a], bodies.bodies[b], "they may have different potentials");
  const std::vector<Contact> contacts = contacts_at_one_potential(bodies);
  return joined(std::move(bodies), contacts);
}

}  // namespace fringe::detail
