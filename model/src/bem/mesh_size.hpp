#pragma once

#include <optional>
#include <vector>

#include "bem/bodies.hpp"

namespace fringe::detail {

/// Chooses the numbers of functions along each direction of every face, body after body, such that they
/// resolve the effect of the other bodies' edges on its charge (model/BOUNDARY_ELEMENTS.md, section 6). They
/// are odd, `least` or more.
///
/// @param features least number of functions for each length over which the charge changes
std::vector<FaceFunctions> a_priori_functions(const ChargedBodies& bodies, double features, int least);

/// Returns the bodies with triangles in place of the faces of each body that would need more than `most`
/// functions along a direction of a face. Returns nothing if there is no such body.
std::optional<ChargedBodies> with_triangles_beyond(const ChargedBodies& bodies, double features, double most);

/// Does the same for each body with a face to which another, far smaller body is close: its effect on the
/// charge there is narrower than any function.
std::optional<ChargedBodies> with_triangles_by_proximity(const ChargedBodies& bodies);

}  // namespace fringe::detail
