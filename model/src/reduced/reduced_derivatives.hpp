#pragma once

#include <vector>

#include "fringe/reading_answer.hpp"
#include "reduced/arrangement.hpp"
#include "reduced/reduced_readings.hpp"
#include "reduced/reduced_system.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// Adds to the readings' answers (m) the derivatives of their changes with respect to the poses of all links,
/// by the forces between the charges of the last solution (model/BOUNDARY_ELEMENTS.md, section 12). They are
/// NaN for a link that moves against a body which it touches.
void write_derivatives(ReducedSystem& system, const Arrangement& bodies,
                       const std::vector<ChargedReading>& readings, ReducedReadings& found);

}  // namespace fringe::detail
