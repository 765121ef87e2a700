#pragma once

#include <optional>
#include <vector>

#include "bem/bodies.hpp"

namespace fringe::detail {

/// How many functions along each direction of every face, body after body, can see what the other bodies'
/// edges do to its charge (model/BOUNDARY_ELEMENTS.md, section 6): odd, `least` or more.
///
/// @param features how many of the lengths over which the charge changes go with one function at least
std::vector<FaceFunctions> resolving_functions(const ChargedBodies& bodies, double features, int least);

/// The bodies with triangles in the place of the faces of all that would take more than `most` functions
/// along a direction of one. Nothing if there are none.
std::optional<ChargedBodies> with_triangles_beyond(const ChargedBodies& bodies, double features, double most);

/// The same where another body close by is far smaller than the face: what it does there is narrower than
/// any function.
std::optional<ChargedBodies> with_triangles_under_narrow_shadows(const ChargedBodies& bodies);

}  // namespace fringe::detail
