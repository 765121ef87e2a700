// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "alpha_wrap.hpp"
#include "surfaces.hpp"

namespace wrap {

/// Collapses edges of `mesh` while it goes on to contain the triangles of `inside`, stays within what is
/// allowed of them, and has no narrower triangles.
void simplify(Mesh& mesh, const Tree& inside, const Lengths& lengths);

/// Tells whether a closed surface contains all of these triangles strictly, and does not meet itself. Decided
/// by exact predicates.
bool contains(const Mesh& mesh, const std::vector<Triangle>& triangles, const Tree& inside);

}  // namespace wrap
