#pragma once

#include <optional>
#include <vector>

#include "bem/reading_derivatives.hpp"
#include "fringe/boundary_elements.hpp"
#include "surface/bodies.hpp"
#include "surface/simplification.hpp"

namespace fringe::detail {

/// An answer by functions on faces and by panels.
struct RefinedMaxwell {
  MaxwellMatrix matrix;
  /// For each body, whether it has a face for which the most functions are too few.
  std::vector<bool> needs_panels;
};

/// Solves for the Maxwell matrix and the readings of conductors with adaptive refinement, in metres (to be
/// multiplied by 4πε), and for derivatives with respect to the poses if there are any; null: none. The bodies
/// are those of the simplification, some of which may have triangles in place of their faces. Returns nothing
/// if `may_give_up` and the simplified surfaces cost too much of what is asked for.
/// @throws InputError if the scene needs more unknowns than allowed.
std::optional<RefinedMaxwell> refined_maxwell(const ChargedBodies& bodies,
                                              const Simplification& simplification, bool may_give_up,
                                              const BoundaryElementOptions& options, const LinkPoses* poses);

}  // namespace fringe::detail
