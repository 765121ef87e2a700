#pragma once

#include <optional>

#include <Eigen/Core>

#include "fringe/triangle.hpp"
#include "sensing/cone_line.hpp"

namespace fringe::detail {

struct NearestPoint {
  double distance;
  Eigen::Vector3d point;
};

/// Finds the point of a finite triangle nearest to the apex among those in a cone of unlimited range. Returns
/// nothing if the triangle is outside the cone.
template <class Method>
std::optional<NearestPoint> nearest_on_triangle(const Triangle& triangle, const Eigen::Vector3d& apex,
                                                const Method& cone);

extern template std::optional<NearestPoint> nearest_on_triangle(const Triangle&, const Eigen::Vector3d&,
                                                                const FieldOfView&);
extern template std::optional<NearestPoint> nearest_on_triangle(const Triangle&, const Eigen::Vector3d&,
                                                                const ConeEquation&);

}  // namespace fringe::detail
