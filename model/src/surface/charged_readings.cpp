#include "surface/charged_readings.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Returns the row of the conductor that a reading names. Throws InputError if there is none.
Index row_of(const std::string& name, const Reading& reading, const std::vector<std::string>& conductors) {
  const auto found = std::find(conductors.begin(), conductors.end(), name);
  if (found == conductors.end())
    throw InputError(fmt::format(
        R"(reading "{}": "{}" is neither a sensor nor the conductor of an electrode)", reading.name, name));
  return found - conductors.begin();
}

}  // namespace

std::vector<std::string> drivable_conductors(const ChargedBodies& bodies) {
  std::vector<std::string> names;
  for (const ChargedConductor& conductor : bodies.conductors)
    names.push_back(conductor.role == Role::sensor || conductor.role == Role::electrode ? conductor.name
                                                                                        : "");
  return names;
}

std::vector<ChargedReading> charged_readings(const std::vector<Reading>& readings,
                                             const std::vector<std::string>& conductors) {
  std::vector<ChargedReading> result;
  for (const Reading& reading : readings) {
    const auto count = static_cast<Index>(conductors.size());
    VectorXd drive = VectorXd::Zero(count);
    for (const std::string& name : reading.drive)
      drive[row_of(name, reading, conductors)] = 1;
    const Index sensed = row_of(reading.sense, reading, conductors);
    const double sign = drive[sensed] > 0 ? 1 : -1;
    result.push_back({reading.name, sign * VectorXd::Unit(count, sensed), std::move(drive)});
  }
  return result;
}

}  // namespace fringe::detail
