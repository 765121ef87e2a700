#pragma once

#include <vector>

#include "bem/charge_nodes.hpp"
#include "fringe/reading_answer.hpp"
#include "geometry/link_motion.hpp"

namespace fringe::detail {

/// Adds to the readings (m) the derivatives of their changes with respect to the poses of all links, and
/// estimates of their errors (model/BOUNDARY_ELEMENTS.md, section 12). The world poses must be up to date.
/// Derivatives are NaN for a link that moves against a body which it touches or almost touches.
void write_derivatives(const ChargeNodes& nodes, const ChargedBodies& bodies, const LinkPoses& poses,
                       std::size_t threads, std::vector<ReadingAnswer>& answers);

}  // namespace fringe::detail
