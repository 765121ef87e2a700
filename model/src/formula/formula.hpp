#pragma once

#include <span>

#include <Eigen/Geometry>

#include "formula/charged_surface.hpp"
#include "fringe/formula_terms.hpp"
#include "fringe/rectangle.hpp"

namespace fringe::detail {

/// Computes the terms of the pair formula (model/CORRECTIONS.md).
///
/// @param sensor_pose maps the sensor's frame to the object's
/// @param plates the sensor's plates in the object's frame
FormulaTerms formula_terms(const ChargedSurface& object, const ChargedSurface& sensor,
                           const Eigen::Isometry3d& sensor_pose, std::span<const Rectangle> plates);

/// Estimates `mutual` over the permittivity, in m.
double formula(const FormulaTerms& terms);

}  // namespace fringe::detail
