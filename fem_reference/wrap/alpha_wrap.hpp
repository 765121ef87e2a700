// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace wrap {

/// A length that grows with the distance to what has another potential.
struct LocalLength {
  /// The length is this share of the distance, but at least `least` and at most `most` (m).
  double share;
  double least;
  double most;

  double at(double distance) const { return std::clamp(share * distance, least, most); }
};

/// The lengths of a wrap at every place.
struct Lengths {
  /// The triangles that have another potential; may be empty, which is the same as infinitely far away.
  const Tree* others;
  /// Radius of the narrowest hollow that the wrap follows.
  LocalLength alpha;
  /// Distance of the wrap from what it contains, before it is simplified.
  LocalLength offset;
  /// Distance of the simplified wrap from what it contains, over the offset at that place.
  double allowed_over_offset;

  double distance_to_others(const Point& point) const {
    return others->empty() ? HUGE_VAL : std::sqrt(others->squared_distance(point));
  }
};

/// Returns CGAL's alpha wrap of the triangles of a soup, with an alpha and an offset that depend on the
/// place.
Mesh alpha_wrap(const Soup& soup, const Lengths& lengths);

}  // namespace wrap
