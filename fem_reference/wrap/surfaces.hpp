// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

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

}  // namespace wrap
