#pragma once

#include <span>

#include <Eigen/Geometry>

#include "charged_surface.hpp"
#include "fringe/rectangle.hpp"

namespace fringe::detail {

/// The correction `formula` (model/CORRECTIONS.md): an estimate of `mutual` over the permittivity, in m.
///
/// @param sensor_pose maps the sensor's frame to the object's
/// @param plates the sensor's plates in the object's frame
double formula(const ChargedSurface& object, const ChargedSurface& sensor, const Eigen::Isometry3d& sensor_pose,
               std::span<const Rectangle> plates);

}  // namespace fringe::detail
