#pragma once

#include <vector>

#include "charged_bodies.hpp"

namespace fringe::detail {

/// How many functions along each direction of every face, body after body, can see what the other bodies'
/// edges do to its charge (model/BOUNDARY_ELEMENTS.md, section 6): odd, `least` or more.
///
/// @param features how many of the lengths over which the charge changes go with one function at least
std::vector<FaceFunctions> resolving_functions(const ChargedBodies& bodies, double features, int least);

}  // namespace fringe::detail
