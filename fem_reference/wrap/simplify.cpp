// SPDX-License-Identifier: GPL-3.0-or-later
#include "wrap.hpp"

#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace wrap {
namespace {

namespace simplification = CGAL::Surface_mesh_simplification;
using Vector = Kernel::Vector_3;

/// Least height of a new triangle over its longest side, unless the triangles that it replaces were narrower.
constexpr double least_height = 0.15;

double height_over_side(const Point& a, const Point& b, const Point& c) {
  const double longest = std::sqrt(
      std::max({CGAL::squared_distance(a, b), CGAL::squared_distance(b, c), CGAL::squared_distance(c, a)}));
  const double doubled_area = std::sqrt(CGAL::cross_product(b - a, c - a).squared_length());
  return longest > 0 ? doubled_area / (longest * longest) : 0;
}

/// Rejects the collapse of an edge whose new triangles would meet what they have to contain, lie too far from
/// it, turn over, or be narrow.
class Filter {
 public:
  Filter(const Tree& inside, const Lengths& lengths) : inside_{&inside}, lengths_{&lengths} {}

  template <typename Profile>
  boost::optional<Point> operator()(const Profile& profile, const boost::optional<Point>& placed) const {
    if (!placed || !is_near(*placed))
      return boost::none;
    const auto& points = profile.vertex_point_map();
    const auto& triangles = profile.triangles();
    const std::size_t vanishing =
        (profile.left_face_exists() ? 1 : 0) + (profile.right_face_exists() ? 1 : 0);
    double narrowest = least_height;
    for (const auto& triangle : triangles)
      narrowest = std::min(narrowest, height_over_side(get(points, triangle.v0), get(points, triangle.v1),
                                                       get(points, triangle.v2)));
    for (std::size_t k = vanishing; k < triangles.size(); ++k) {
      const Point& a = get(points, triangles[k].v0);
      const Point& before = get(points, triangles[k].v1);
      const Point& c = get(points, triangles[k].v2);
      const Point& b = *placed;
      const Vector old_normal = CGAL::cross_product(before - a, c - a);
      if (old_normal * CGAL::cross_product(b - a, c - a) <= 0 || height_over_side(a, b, c) < narrowest)
        return boost::none;
      if (!is_near(CGAL::midpoint(a, b)) || !is_near(CGAL::midpoint(b, c)) ||
          !is_near(CGAL::centroid(a, b, c)))
        return boost::none;
      const Triangle made{a, b, c};
      if (made.is_degenerate() || inside_->do_intersect(made))
        return boost::none;
    }
    return placed;
  }

 private:
  bool is_near(const Point& point) const {
    const double allowed =
        lengths_->allowed_over_offset * lengths_->offset.at(lengths_->distance_to_others(point));
    return inside_->squared_distance(point) <= allowed * allowed;
  }

  const Tree* inside_;
  const Lengths* lengths_;
};

}  // namespace

void simplify(Mesh& mesh, const Tree& inside, const Lengths& lengths) {
  simplification::edge_collapse(mesh, simplification::Count_stop_predicate<Mesh>{4},
                                CGAL::parameters::get_cost(simplification::LindstromTurk_cost<Mesh>{})
                                    .get_placement(simplification::LindstromTurk_placement<Mesh>{})
                                    .filter(Filter{inside, lengths}));
  mesh.collect_garbage();
}

bool contains(const Mesh& mesh, const std::vector<Triangle>& triangles, const Tree& inside) {
  if (!CGAL::is_closed(mesh) || CGAL::Polygon_mesh_processing::does_self_intersect(mesh))
    return false;
  for (const auto face : mesh.faces()) {
    std::array<Point, 3> corners;
    std::size_t k = 0;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face)))
      corners[k++] = mesh.point(vertex);
    if (inside.do_intersect(Triangle{corners[0], corners[1], corners[2]}))
      return false;
  }
  // No triangle meets the surface, so that each of them is inside if one of its corners is.
  const CGAL::Side_of_triangle_mesh<Mesh, Kernel> side{mesh};
  return std::all_of(triangles.begin(), triangles.end(),
                     [&](const Triangle& triangle) { return side(triangle[0]) == CGAL::ON_BOUNDED_SIDE; });
}

}  // namespace wrap
