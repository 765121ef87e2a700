#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "geometry/plate_frame.hpp"
#include "integral/tree/node.hpp"

/// Bounds of the errors of the quadratures of a node and of its triangles (model/NUMERICS.md, section 11).
namespace fringe::detail {

/// Distances of a node's centre.
struct Placement {
  double distance;  ///< distance from the plate
  double border_u;  ///< distance from the nearer of the two border planes normal to x
  double border_v;  ///< the same for y
};

inline Placement place(const PlateFrame& plate, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d local = plate.axes * (centre - plate.corner);
  return {detail::distance(plate, local), std::min(std::abs(local.x()), std::abs(local.x() - plate.length_u)),
          std::min(std::abs(local.y()), std::abs(local.y() - plate.length_v))};
}

/// Bounds the error that the kinks of the distance in the plate's border planes cause, for any of a node's
/// quadratures.
inline double kink_error(const PlateFrame& plate, const Placement& placement, const Node& node) {
  const double radius = node.radius;
  if (std::min(placement.border_u, placement.border_v) >= radius)
    return 0;
  double sum = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const double border = axis == 0 ? placement.border_u : placement.border_v;
    if (border >= radius)
      continue;
    const double share_beyond = 1 - border / radius;
    sum += share_beyond * share_beyond * node.second_moment.along(plate.axes.row(axis));
  }
  const double nearest = placement.distance - radius, ratio = radius / nearest;
  return node.area / nearest * ratio * ratio * sum / 2;
}

/// Bounds the errors of the quadratures of a node whose sphere lies in one cell. The centre must be farther
/// from the plate than the radius.
inline PerQuadrature smooth_errors(const Placement& placement, const Node& node) {
  const double ratio = node.radius / placement.distance, scale = node.area / placement.distance;
  PerQuadrature sums{};
  for (std::size_t step = 0; step < sums.size(); ++step)
    sums[step] = node.errors.remainder[step] * (ratio / (1 - ratio));
  for (std::size_t k = node.errors.mismatch.size(); k-- > 1;)
    for (std::size_t step = 0; step < sums.size(); ++step)
      sums[step] = (sums[step] + node.errors.mismatch[k][step]) * ratio;
  for (std::size_t step = 0; step < sums.size(); ++step)
    sums[step] = (sums[step] + node.errors.mismatch[0][step]) * scale;
  return sums;
}

/// The quadrature that replaces a node's surface, with the bound of its error.
struct Lump {
  std::size_t quadrature;
  double error;
};

/// Returns the quadrature with the fewest points whose error bound is at most `allowed`, if there is one.
inline std::optional<Lump> lump(const PlateFrame& plate, const Placement& placement, const Node& node,
                                double allowed) {
  if (!(placement.distance > node.radius))
    return std::nullopt;
  // Tests the remainder beyond the form of the highest degree first, because most nodes fail by it.
  const double ratio = node.radius / placement.distance, cube = ratio * ratio * ratio;
  if (node.smallest_remainder * cube * cube * ratio * node.area >
      allowed * (placement.distance - node.radius))
    return std::nullopt;
  const double kinks = kink_error(plate, placement, node);
  if (!(kinks <= allowed))
    return std::nullopt;
  const PerQuadrature errors = smooth_errors(placement, node);
  for (std::size_t step = 0; step < errors.size(); ++step)
    if (const double error = errors[step] + kinks; error <= allowed)
      return Lump{step, error};
  return std::nullopt;
}

/// Computes a lower bound of the distance between a leaf's triangles and the plate.
inline double nearest_distance(const Placement& placement, const Node& leaf) {
  return placement.distance - leaf.trianglewise.reach - leaf.trianglewise.largest_radius;
}

/// Bounds the summed error of the quadratures of a leaf's triangles, without the contribution of the border
/// planes.
inline double trianglewise_error(const Placement& placement, const Node& leaf) {
  const double centroids = placement.distance - leaf.trianglewise.reach;
  const double nearest = nearest_distance(placement, leaf);
  if (!(nearest > 0))
    return std::numeric_limits<double>::infinity();
  const double ratio = leaf.radius / centroids;
  return leaf.area / centroids * ratio * ratio * ratio *
         (leaf.trianglewise.mismatch + leaf.trianglewise.remainder * leaf.radius / nearest);
}

/// Bounds, for each triangle of a leaf, the quadrature error (m) that the kinks of the distance in the
/// plate's border planes cause: 0 where no border plane crosses the triangle. nearest_distance of the leaf
/// must be positive.
/// @param points quadrature points of all triangles of the tree
/// @param errors one element per triangle of the leaf
void border_errors(const PlateFrame& plate, const Placement& placement, const Node& leaf,
                   const PointArrays& points, double* errors);

}  // namespace fringe::detail
