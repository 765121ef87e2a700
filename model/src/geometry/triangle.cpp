#include "fringe/triangle.hpp"

#include <numeric>

#include "geometry/surface_mesh.hpp"
#include "numeric/compensated.hpp"

namespace fringe {

using Eigen::Vector3d;

double twice_area(const Triangle& triangle) {
  const Vector3d edge0 = triangle[2] - triangle[1];
  const Vector3d edge1 = triangle[0] - triangle[2];
  const Vector3d edge2 = triangle[1] - triangle[0];
  const double squared0 = edge0.squaredNorm(), squared1 = edge1.squaredNorm(), squared2 = edge2.squaredNorm();
  // The two shorter edges carry the smallest rounding error into the cross product.
  if (squared0 >= squared1 && squared0 >= squared2)
    return detail::cross(edge1, edge2).norm();
  if (squared1 >= squared2)
    return detail::cross(edge2, edge0).norm();
  return detail::cross(edge0, edge1).norm();
}

double area(std::span<const Triangle> triangles) {
  return std::accumulate(triangles.begin(), triangles.end(), 0.0,
                         [](double sum, const Triangle& triangle) { return sum + twice_area(triangle) / 2; });
}

double signed_volume(std::span<const Triangle> triangles) {
  if (triangles.empty())
    return 0;
  // The tetrahedra have a point of the surface as their common apex, which avoids cancellation far from the
  // world's origin.
  const Vector3d apex = triangles.front()[0];
  double sixfold = 0;
  for (const Triangle& triangle : triangles)
    sixfold += (triangle[0] - apex).dot((triangle[1] - apex).cross(triangle[2] - apex));
  return sixfold / 6;
}

bool is_closed(std::span<const Triangle> triangles) {
  return detail::SurfaceMesh(triangles).is_closed();
}

Eigen::AlignedBox3d axis_aligned_box(std::span<const Triangle> triangles) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : triangles)
    for (const Vector3d& vertex : triangle)
      box.extend(vertex);
  return box;
}

}  // namespace fringe
