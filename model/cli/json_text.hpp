#pragma once

#include <string>
#include <vector>

#include "fringe/capacitance.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_sensing.hpp"

/// Writes the answers as JSON documents. Infinity is written as 1e999, which is a valid JSON number.
namespace fringe::cli {

std::string capacitance_json(const SceneCapacitance& answer, const CapacitanceOptions& options,
                             double seconds);

std::string readings_json(const std::vector<DistanceReading>& readings);

std::string collision_json(const SceneCollision& answer, const Scene& scene);

std::string info_json(const SceneInfo& info);

}  // namespace fringe::cli
