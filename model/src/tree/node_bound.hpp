#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "../plate_frame.hpp"
#include "node.hpp"

/// What the quadratures of a node are off, at most (model/NUMERICS.md, section 11).
namespace fringe::detail {

/// Where a node's centre lies.
struct Placement {
  double distance;  ///< from the plate
  double border_u;  ///< from the nearer of the two planes on the plate's edges that cross x
  double border_v;
};

inline Placement place(const PlateFrame& plate, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d local = plate.axes * (centre - plate.corner);
  return {detail::distance(plate, local), std::min(std::abs(local.x()), std::abs(local.x() - plate.length_u)),
          std::min(std::abs(local.y()), std::abs(local.y() - plate.length_v))};
}

/// What the kinks of the distance in the plate's border planes add to the error, at most, when the points are
/// no farther than `radius` from centres that are no nearer to the border planes than `placement` says, and
/// no point is nearer than `nearest` to the plate.
inline double kink_error(const PlateFrame& plate, const Placement& placement, double radius, double nearest,
                         const SymmetricMatrix& second_moment) {
  if (std::min(placement.border_u, placement.border_v) >= radius)
    return 0;
  double sum = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const double border = axis == 0 ? placement.border_u : placement.border_v;
    if (border >= radius)
      continue;
    const double share_beyond = 1 - std::max(border, 0.0) / radius;
    sum += share_beyond * share_beyond * second_moment.along(plate.axes.row(axis));
  }
  return sum / (2 * nearest * nearest * nearest);
}

/// The points that stand for a node, with the bound of their error.
struct Lump {
  const Quadrature* quadrature;  ///< none: the centre alone
  double error;
};

/// The fewest points whose error is not above what is allowed, if there are any.
inline std::optional<Lump> lump(const PlateFrame& plate, const Placement& placement, const Node& node,
                                double allowed) {
  const double nearest = placement.distance - node.radius;
  if (!(nearest > 0))
    return std::nullopt;
  const double kinks = kink_error(plate, placement, node.radius, nearest, node.second_moment);
  if (kinks > allowed)
    return std::nullopt;
  const double inverse = 1 / placement.distance;
  double factor = inverse * inverse / nearest;  // D^−(degree + 2)/(1 − R/D), here for degree 1
  if (const double error = kinks + node.squared_radius_moment * factor; error <= allowed)
    return Lump{nullptr, error};
  int degree = 1;
  for (const Quadrature& quadrature : node.quadratures) {
    for (; degree < quadrature.degree; ++degree)
      factor *= inverse;
    double error = kinks + quadrature.remainder * factor;
    if (error > allowed)
      continue;
    double mismatch = 0;
    for (int k = quadrature.degree; k >= 0; --k)
      mismatch = (mismatch + quadrature.mismatch[static_cast<std::size_t>(k)]) * inverse;
    error += mismatch;
    if (error <= allowed)
      return Lump{&quadrature, error};
  }
  return std::nullopt;
}

/// The error of the quadratures of a leaf's triangles together.
inline double trianglewise_error(const PlateFrame& plate, const Placement& placement, const Node& node) {
  const TrianglewiseQuadrature& quadrature = node.trianglewise;
  const double centroids = placement.distance - quadrature.reach;
  const double nearest = centroids - quadrature.largest_radius;
  if (!(nearest > 0))
    return std::numeric_limits<double>::infinity();
  const Placement closest{centroids, placement.border_u - quadrature.reach,
                          placement.border_v - quadrature.reach};
  return quadrature.remainder / (centroids * centroids * centroids * nearest) +
         kink_error(plate, closest, quadrature.largest_radius, nearest, quadrature.second_moment);
}

}  // namespace fringe::detail
