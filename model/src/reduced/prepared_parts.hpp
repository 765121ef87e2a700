#pragma once

#include <string>
#include <vector>

#include "fringe/scene.hpp"
#include "io/prepared_files.hpp"
#include "surface/bodies.hpp"

/// Keeps machine, links and targets of readings before a machine in files, found by all that they depend on.
namespace fringe::detail {

/// Returns all of some bodies that the charges on them depend on.
std::string bytes_of_bodies(const ChargedBodies& bodies);

/// Returns what readings sense and drive.
template <typename Reading>
std::string bytes_of_readings(const std::vector<Reading>& readings) {
  ArchiveWriter archive;
  archive(readings.size());
  for (const Reading& reading : readings)
    archive(reading.name, reading.sense, reading.drive);
  return archive.bytes();
}

}  // namespace fringe::detail
