#pragma once

#include <span>

#include "correction/charged_surface.hpp"
#include "fringe/rectangle.hpp"

/// Corrections that integrate over the object and over the sensor, both in the object's frame.
namespace fringe::detail {

/// Computes √(∫dA/d over the object · ∫dA/d over the sensor's plates), in m; `on_object` is the first
/// integral.
double reciprocal_integral(const ChargedSurface& object, std::span<const Rectangle> plates, double on_object);

/// Computes √(A B), where A and B are each ∫dA (1/L_front + 1/L_back) over one surface, in m; field lines are
/// taken as arcs (model/CORRECTIONS.md).
double two_sided_arcs(const ChargedSurface& object, std::span<const Rectangle> plates);

}  // namespace fringe::detail
