#pragma once

#include <span>

#include <Eigen/Geometry>

#include "formula/charged_surface.hpp"
#include "fringe/rectangle.hpp"

namespace fringe::detail {

/// The terms of the pair formula for one sensor and one object (model/CORRECTIONS.md); in m unless
/// stated otherwise.
struct FormulaTerms {
  /// The variation, over a body, of the potential of the other body's own charge: variances relative to the
  /// squared mean.
  struct Variation {
    double linear = 0;
    double quadratic = 0;
    double remaining = 0;
  };
  double own_of_sensor = 0;  ///< C/ε of the sensor alone
  double own_of_object = 0;
  double potential = 0;  ///< 1/m: mean potential of one body's own charge on the other, per charge over ε
  Variation on_sensor;
  Variation on_object;
  double drawn = 0;          ///< mutual attraction of the two charges (no unit)
  double flux = 0;           ///< ∫dA/L between sides that face each other; +infinity on contact
  double soft_flux = 0;      ///< the same with softened gaps
  double tilted_excess = 0;  ///< their difference weighted by 1 − cos θ
  double facing_area = 0;    ///< m²
};

/// Computes the terms of the pair formula (model/CORRECTIONS.md).
///
/// @param sensor_pose maps the sensor's frame to the object's
/// @param plates the sensor's plates in the object's frame
FormulaTerms formula_terms(const ChargedSurface& object, const ChargedSurface& sensor,
                           const Eigen::Isometry3d& sensor_pose, std::span<const Rectangle> plates);

/// Estimates `mutual` over the permittivity, in m.
double formula(const FormulaTerms& terms);

}  // namespace fringe::detail
