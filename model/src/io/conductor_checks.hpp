#pragma once

#include <vector>

#include "fringe/scene.hpp"
#include "io/table_reader.hpp"

/// Checks of a scene that concern several of its objects and readings. Each is given the tables from which
/// they were read, in the same order, and throws InputError about the first that is wrong.
namespace fringe::detail {

/// Rejects conductors whose objects differ in potential or in the capacitance to ground, and conductors with
/// the name of a sensor or of an object outside them.
void require_conductors(const Scene& scene, const std::vector<TableReader>& objects);

/// Rejects targets that are electrodes, that carry a sensor, or that are a part of a floating conductor only.
/// The conductors must have been checked.
void require_targets(const Scene& scene, const std::vector<TableReader>& objects);

/// Rejects readings that sense or drive what is neither a sensor nor the conductor of an electrode.
void require_readings(const Scene& scene, const std::vector<TableReader>& readings);

}  // namespace fringe::detail
