#pragma once

#include "fringe/scene.hpp"

/// The layer rule for covers (model/CORRECTIONS.md, section 9).
namespace fringe::detail {

/// What stands for a covered plate.
enum class CoveredPlate {
  moved,   ///< the plate, moved to the front
  doubled  ///< the plate and, before it, the moved one
};

/// Returns true if a sensor of the scene has a cover.
bool has_covers(const Scene& scene);

/// Returns a scene whose sensors have no covers: each covered plate is moved to the front by t·(1 − ε/ε'), t
/// and ε' the thickness and the permittivity of the cover and ε that of the medium. To a field that crosses
/// it, the cover is as thick as the gap that is left, t·ε/ε'.
Scene without_covers(const Scene& scene, CoveredPlate stand_in);

}  // namespace fringe::detail
