// SPDX-License-Identifier: GPL-3.0-or-later
#include "wrap.hpp"

#include <CGAL/Alpha_wrap_3/internal/Alpha_wrap_3.h>
#include <CGAL/Alpha_wrap_3/internal/Triangle_soup_oracle.h>

#include <algorithm>

namespace wrap {

namespace internal = CGAL::Alpha_wraps_3::internal;
using Vector = Kernel::Vector_3;

/// Precision to which points at the distance of the offset are found, over the least offset; CGAL's own.
constexpr double precision_over_offset = 1e-2;

/// The kernel of the triangulation, which carries the lengths to where alpha is compared.
struct LocalKernel : Kernel {
  const Lengths* lengths = nullptr;
};

/// Tells whether a facet is wide enough to pass: CGAL's test with the alpha of the facet's place, the
/// smallest of those at its corners and in its middle. CGAL's algorithm calls this in the place of its own
/// test, by argument-dependent lookup, for triangulations of a LocalKernel.
template <typename Triangulation>
requires requires(const Triangulation& cells) {
  cells.geom_traits().lengths;
}
bool less_squared_radius_of_min_empty_sphere(typename Triangulation::Geom_traits::FT,
                                             const typename Triangulation::Facet& facet,
                                             const Triangulation& cells) {
  const Lengths& lengths = *cells.geom_traits().lengths;
  const auto corner = [&](int k) { return cells.point(facet.first, (facet.second + k) % 4); };
  const Point a = corner(1), b = corner(2), c = corner(3);
  double nearest = HUGE_VAL;
  for (const Point& point : {a, b, c, CGAL::centroid(a, b, c)})
    nearest = std::min(nearest, lengths.distance_to_others(point));
  const double alpha = lengths.alpha.at(nearest);
  return internal::less_squared_radius_of_min_empty_sphere(alpha * alpha, facet, cells);
}

namespace {

using Triangles = internal::Triangle_soup_oracle<LocalKernel>;
using Ball = Triangles::Geom_traits::Ball_3;

/// What CGAL's algorithm asks about the triangles, with the offset of each place. The algorithm itself is
/// given the largest offset, which these answers replace.
class LocalOffset : public Triangles {
 public:
  LocalOffset(const Soup& soup, const LocalKernel& kernel)
      : Triangles{kernel.lengths->alpha.least, kernel}, lengths_{kernel.lengths} {
    add_triangle_soup(soup.points, soup.faces, CGAL::parameters::default_values());
  }

  using Triangles::do_intersect;

  /// Tells whether the triangles are within the offset of a ball's centre; its radius is the largest offset.
  bool do_intersect(const Ball& ball) const {
    const Point& centre = ball.boundary().center();
    const double offset = offset_at(centre);
    return Triangles::do_intersect(geom_traits().construct_ball_3_object()(centre, offset * offset));
  }

  /// Finds the first point on the way from p to q that is at the distance of the offset.
  bool first_intersection(const Point& p, const Point& q, Point& found, double) const {
    const auto beyond = [this](const Point& point) {
      return std::sqrt(squared_distance(point)) - offset_at(point);
    };
    internal::Offset_intersection<LocalKernel, decltype(beyond)> search{
        beyond, 0.0, precision_over_offset * lengths_->offset.least, 1 + lengths_->offset.share};
    return search.first_intersection(p, q, found);
  }

  /// Returns a point from which the largest offset, towards p, leads to where the triangles' nearest point is
  /// at the distance of the offset.
  Point closest_point(const Point& p) const {
    const Point closest = Triangles::closest_point(p);
    const Vector towards = p - closest;
    const double behind = lengths_->offset.most - offset_at(closest);
    return closest - behind / std::sqrt(towards.squared_length()) * towards;
  }

 private:
  double offset_at(const Point& point) const {
    return lengths_->offset.at(lengths_->distance_to_others(point));
  }

  const Lengths* lengths_;
};

}  // namespace

Mesh alpha_wrap(const Soup& soup, const Lengths& lengths) {
  LocalKernel kernel;
  kernel.lengths = &lengths;
  const LocalOffset oracle{soup, kernel};
  Mesh wrapped;
  internal::Alpha_wrap_3<LocalOffset>{oracle}(lengths.alpha.least, lengths.offset.most, wrapped);
  return wrapped;
}

}  // namespace wrap
