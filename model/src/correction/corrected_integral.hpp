#pragma once

#include <span>

#include <Eigen/Geometry>

#include "correction/charged_surface.hpp"
#include "fringe/correction.hpp"
#include "fringe/rectangle.hpp"
#include "fringe/triangle_batch.hpp"

namespace fringe::detail {

/// Computes a correction's replacement for Σ∫dA/d, in m, for bodies that do not touch.
///
/// @param batch the object's triangles
/// @param sensor_pose maps the sensor's frame to the object's
/// @param plates the sensor's plates in the object's frame
double corrected_integral(Correction correction, const ChargedSurface& object, const TriangleBatch& batch,
                          const ChargedSurface& sensor, const Eigen::Isometry3d& sensor_pose,
                          std::span<const Rectangle> plates);

}  // namespace fringe::detail
