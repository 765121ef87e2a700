#pragma once

#include <optional>
#include <vector>

#include "charged_bodies.hpp"

namespace fringe::detail {

/// How many functions along each direction of every face, body after body, can see what the other bodies'
/// edges do to its charge (model/BOUNDARY_ELEMENTS.md, section 6): odd, `least` or more.
///
/// @param features how many of the lengths over which the charge changes go with one function at least
std::vector<FaceFunctions> resolving_functions(const ChargedBodies& bodies, double features, int least);

/// The bodies with triangles in the place of the faces of all objects that would take more than `most`
/// functions along a direction of one: before a body far smaller than they are, close to the middle. Nothing
/// if there are none. Sensors stay what they are.
std::optional<ChargedBodies> with_triangles_beyond(const ChargedBodies& bodies, double features, double most);

}  // namespace fringe::detail
