// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace wrap {

/// Predicates are exact, coordinates are double precision.
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Mesh = CGAL::Surface_mesh<Point>;

/// Triangles in any state: holes, duplicates, crossings and wrong orientations are allowed.
struct Soup {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;

  /// Returns the triangles that have an area.
  std::vector<Triangle> triangles() const;
};

using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

/// Reads an OFF file. Throws std::runtime_error that names the file.
Soup read_soup(const std::string& file);

/// Writes a closed surface as an OFF file, with coordinates that are read back exactly. Throws
/// std::runtime_error.
void write_mesh(const std::string& file, const Mesh& mesh);

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

/// Collapses edges of `mesh` while it goes on to contain the triangles of `inside`, stays within what is
/// allowed of them, and has no narrower triangles.
void simplify(Mesh& mesh, const Tree& inside, const Lengths& lengths);

/// Tells whether a closed surface contains all of these triangles strictly, and does not meet itself. Decided
/// by exact predicates.
bool contains(const Mesh& mesh, const std::vector<Triangle>& triangles, const Tree& inside);

}  // namespace wrap
