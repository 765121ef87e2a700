#pragma once

#include <nlohmann/json_fwd.hpp>

#include "fringe/scene.hpp"

namespace fringe::answers {

/// Describes "objects", by name: "potential" ("dielectric" with "relative_permittivity" for those that do not
/// conduct), "conductor", "to_ground" (F; null: not connected) and "target"; and "readings", by name:
/// "sense", "drive", "noise" and "threshold" (F or null). What the scene leaves out is filled in.
nlohmann::ordered_json scene_roles(const Scene& scene);

}  // namespace fringe::answers
