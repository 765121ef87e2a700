// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "surfaces.hpp"

namespace wrap {

/// How far a simplified surface may be from the triangles that it contains.
struct Allowance {
  /// Everywhere (m).
  double everywhere;
  /// Where more is allowed: this share of the distance to the nearest of `others`, but at most `most` (m).
  double share;
  double most;
};

/// Collapses edges of `mesh` while it goes on to contain the triangles of `inside`, stays within what is
/// allowed of them, and has no narrower triangles. `others` are the triangles near which the surface has to
/// be exact; the tree may be empty.
void simplify(Mesh& mesh, const Tree& inside, const Tree& others, const Allowance& allowance);

/// Tells whether a closed surface contains all of these triangles strictly, and does not meet itself. Decided
/// by exact predicates.
bool contains(const Mesh& mesh, const std::vector<Triangle>& triangles, const Tree& inside);

}  // namespace wrap
