#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bem/jacobi_basis.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// Chooses the numbers of functions along each direction of every face, body after body, such that they
/// resolve the effect of the other bodies' edges on its charge (model/BOUNDARY_ELEMENTS.md, section 6). They
/// are odd, `least` or more.
///
/// @param features least number of functions for each length over which the charge changes
std::vector<FaceFunctions> a_priori_functions(const ChargedBodies& bodies, double features, int least);

/// Returns how many functions these are in all, for each number of `features`.
std::vector<double> numbers_of_functions(const ChargedBodies& bodies, std::span<const double> features,
                                         int least);

/// Returns the bodies with triangles in place of the faces of those that are chosen, one choice for each
/// body. Returns nothing if none is.
std::optional<ChargedBodies> with_triangles(const ChargedBodies& bodies, const std::vector<bool>& chosen);

/// Does so for each body with a face to which another, far smaller body is close: its effect on the charge
/// there is narrower than any function.
std::optional<ChargedBodies> with_triangles_by_proximity(const ChargedBodies& bodies);

}  // namespace fringe::detail
