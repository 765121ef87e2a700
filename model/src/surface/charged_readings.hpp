#pragma once

#include <string>
#include <vector>

#include "fringe/reading.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// Returns the names of all conductors that may be sensed and driven, in their rows; empty for others.
std::vector<std::string> drivable_conductors(const ChargedBodies& bodies);

/// Returns readings by the potentials of the conductors of these names. Throws InputError for a reading of a
/// conductor that is not among them.
std::vector<ChargedReading> charged_readings(const std::vector<Reading>& readings,
                                             const std::vector<std::string>& conductors);

}  // namespace fringe::detail
