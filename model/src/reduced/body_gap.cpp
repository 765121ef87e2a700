#include "reduced/body_gap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/gjk_filter.hpp"
#include "reduced/prepared_mesh.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

BoxNumbers placed_box(const PlacedBody& body, const BoxNumbers& box) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(box.axes);
  return box_along(body.axes * axes,
                   body.centre + body.axes * (body.scale * Eigen::Map<const Vector3d>(box.centre)),
                   body.scale * Eigen::Map<const Vector3d>(box.half_widths));
}

/// Returns a box around the whole body.
BoxNumbers whole_box(const PlacedBody& body) {
  return body.shape->mesh() != nullptr
             ? placed_box(body, body.shape->mesh()->box())
             : box_along(body.axes, body.centre, body.scale * body.shape->half_sides());
}

/// A part of a body, with a box and a sphere around it.
struct BodyPiece {
  BoxNumbers box;
  Vector3d centre;
  double radius;
};

std::vector<BodyPiece> pieces_of(const PlacedBody& body) {
  std::vector<BodyPiece> pieces;
  if (body.shape->mesh() == nullptr) {
    pieces.push_back({whole_box(body), body.centre, body.scale * body.shape->half_sides().norm()});
    return pieces;
  }
  for (const PanelCluster& cluster : body.shape->mesh()->panels().clusters)
    pieces.push_back({placed_box(body, cluster.box), body.centre + body.axes * (body.scale * cluster.centre),
                      body.scale * cluster.radius});
  return pieces;
}

/// Returns true if a closed body of triangles may contain the other. It does not if a point of the other is
/// outside its box.
bool may_hold(const PlacedBody& outer, const BoxNumbers& box, const PlacedBody& other) {
  if (outer.shape->mesh() == nullptr || !outer.shape->mesh()->is_closed())
    return false;
  const NodePoints points = other.shape->edge_points();
  for (std::ptrdiff_t k = 0; k < points.count; ++k) {
    const Vector3d point =
        other.centre + other.axes * (other.scale * Vector3d(points.x[k], points.y[k], points.z[k]));
    for (Index axis = 0; axis < 3; ++axis) {
      double along = 0;
      for (Index row = 0; row < 3; ++row)
        along += box.axes[3 * row + axis] * (point[row] - box.centre[row]);
      if (std::abs(along) > box.half_widths[axis])
        return false;
    }
  }
  return true;
}

}  // namespace

double body_gap(const PlacedBody& a, const PlacedBody& b) {
  const auto& search = best_kernels<GjkFilter>();
  const BoxNumbers box_a = whole_box(a), box_b = whole_box(b);
  const double apart = search.box_gap(box_a, box_b);
  if (apart > 0)
    return apart;
  if (may_hold(a, box_a, b) || may_hold(b, box_b, a))
    return 0;
  const std::vector<BodyPiece> pieces_a = pieces_of(a), pieces_b = pieces_of(b);
  double least = std::numeric_limits<double>::infinity();
  for (const BodyPiece& one : pieces_a)
    for (const BodyPiece& other : pieces_b) {
      const double spheres = (one.centre - other.centre).norm() - one.radius - other.radius;
      if (spheres < least)
        least = std::min(least, std::max(spheres, search.box_gap(one.box, other.box)));
    }
  return least;
}

}  // namespace fringe::detail
