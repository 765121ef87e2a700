#pragma once

#include <cstddef>

#include "fringe/boundary_elements.hpp"
#include "surface/insulators.hpp"
#include "surface/simplification.hpp"

namespace fringe::detail {

/// Computes the Maxwell matrix of conductors beside dielectric bodies, refined until the estimated errors are
/// within rtol or the matrices too large (model/BOUNDARY_ELEMENTS.md, section 13). In metres, to be
/// multiplied by 4πε. No entry is a lower bound. The surfaces of the conductors are those of a
/// simplification. Throws InputError if these have too many panels.
MaxwellMatrix insulated_maxwell(const InsulatedBodies& given, const Simplification& simplification,
                                const BoundaryElementOptions& options);

/// Returns the largest number of triangles of simplified conductors beside dielectric bodies.
std::size_t most_triangles_beside_insulators(const BoundaryElementOptions& options);

}  // namespace fringe::detail
