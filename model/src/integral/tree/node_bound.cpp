#include "integral/tree/node_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "integral/tree/build.hpp"
#include "integral/tree/kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

/// Bounds from above the mean of t² over a triangle and the mean over the points halfway from its centroid to
/// its corners. Here t is the height beyond a plane on the side away from the centroid. The arguments are the
/// heights of the corners: t is convex, so it nowhere exceeds the linear interpolation of its values there.
double squared_height_beyond(double a, double b, double c) {
  const double side = a + b + c > 0 ? -1.0 : 1.0;
  const double at_a = std::max(side * a, 0.0), at_b = std::max(side * b, 0.0), at_c = std::max(side * c, 0.0);
  const double sum = at_a + at_b + at_c;
  return (at_a * at_a + at_b * at_b + at_c * at_c + sum * sum) / 12;
}

}  // namespace

void border_errors(const PlateFrame& plate, const Placement& placement, const Node& leaf,
                   const PointArrays& points, double* errors) {
  const std::size_t first = points_per_triangle * leaf.triangles.first;
  const std::size_t size = points_per_triangle * leaf.triangles.count;
  std::fill_n(errors, leaf.triangles.count, 0.0);
  const double reach = leaf.trianglewise.reach + leaf.trianglewise.largest_radius;
  const double nearest = nearest_distance(placement, leaf);
  // The error is ∫t² dA/(2·nearest³). Each point has a third of the triangle's area as its weight.
  const double factor = 3 / (2 * nearest * nearest * nearest);
  std::array<double, points_per_triangle * most_triangles_in_leaf> heights;
  const auto& kernels = best_kernels<TreeKernels>();
  const Eigen::Vector3d local = plate.axes * (leaf.centre - plate.corner);
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector3d normal = plate.axes.row(axis);
    for (const double border : {0.0, axis == 0 ? plate.length_u : plate.length_v}) {
      if (std::abs(local[axis] - border) >= reach)
        continue;
      const Plane plane{{normal.x(), normal.y(), normal.z()}, normal.dot(plate.corner) + border};
      kernels.measure_heights(plane, points.x.data() + first, points.y.data() + first,
                              points.z.data() + first, size, heights.data());
      for (std::size_t i = 0; i < leaf.triangles.count; ++i) {
        const double* const at = heights.data() + points_per_triangle * i;
        // The points lie halfway from the centroid to the corners.
        const double centroid = (at[0] + at[1] + at[2]) / 3;
        const double a = 2 * at[0] - centroid, b = 2 * at[1] - centroid, c = 2 * at[2] - centroid;
        if (std::min({a, b, c}) < 0 && std::max({a, b, c}) > 0)
          errors[i] +=
              factor * points.weight[first + points_per_triangle * i] * squared_height_beyond(a, b, c);
      }
    }
  }
}

}  // namespace fringe::detail
