#include "triangle_sets.hpp"

#include <algorithm>
#include <cmath>

#include "fringe/triangulation.hpp"
#include "random.hpp"

namespace fringe::benchmarks {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double side = 0.1;

double distance_from_plate(const Vector3d& point) {
  return std::hypot(point.x() - std::clamp(point.x(), 0.0, side),
                    point.y() - std::clamp(point.y(), 0.0, side), point.z());
}

/// Returns a triangle with its corners on a sphere about `centre`.
Triangle triangle_about(Random& random, const Vector3d& centre, double radius) {
  Triangle triangle;
  for (Vector3d& vertex : triangle)
    vertex = centre + radius * random.direction();
  return triangle;
}

std::vector<Triangle> triangles_in(const AlignedBox3d& box, double size_over_distance, std::size_t count) {
  Random random;
  std::vector<Triangle> triangles(count);
  for (Triangle& triangle : triangles) {
    const Vector3d centre = random.in_box(box);
    triangle = triangle_about(random, centre, size_over_distance * distance_from_plate(centre));
  }
  return triangles;
}

/// Returns the box of the centres. It is so far inside the region's cell, and so high, that coarse triangles
/// stay in one cell and do not meet the plate's plane.
AlignedBox3d box(Region region) {
  switch (region) {
  case Region::face:
    return {Vector3d{0.04, 0.04, 0.02}, Vector3d{0.06, 0.06, 0.1}};
  case Region::edge:
    return {Vector3d{-0.08, 0.045, 0.04}, Vector3d{-0.05, 0.055, 0.06}};
  case Region::corner:
    break;
  }
  return {Vector3d{-0.1, -0.1, 0.06}, Vector3d{-0.06, -0.06, 0.1}};
}

std::string thesis_name(Region region) {
  switch (region) {
  case Region::face:
    return "I";
  case Region::edge:
    return "II";
  case Region::corner:
    break;
  }
  return "III";
}

}  // namespace

Rectangle measured_plate() {
  return {{0, 0, 0}, {side, 0, 0}, {0, side, 0}};
}

TriangleSet fine_triangles(Region region, std::size_t count) {
  return {thesis_name(region) + "_fine", triangles_in(box(region), 0.02, count)};
}

TriangleSet coarse_triangles(Region region, std::size_t count) {
  return {thesis_name(region) + "_coarse", triangles_in(box(region), 0.3, count)};
}

TriangleSet small_straddlers(std::size_t count) {
  const AlignedBox3d over_an_edge{Vector3d{0, 0.02, 0.02}, Vector3d{0, 0.08, 0.1}};
  const AlignedBox3d beside_a_corner{Vector3d{-0.1, 0, 0.02}, Vector3d{-0.02, 0, 0.1}};
  Random random;
  std::vector<Triangle> triangles(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d centre = random.in_box(i % 2 == 0 ? over_an_edge : beside_a_corner);
    const double size = random.uniform(0.02, 0.1) * distance_from_plate(centre);
    Triangle& triangle = triangles[i];
    triangle = triangle_about(random, centre, size);
    const Vector3d shift = centre - (triangle[0] + triangle[1] + triangle[2]) / 3;
    for (Vector3d& vertex : triangle)
      vertex += shift;
  }
  return {"straddling_small", triangles};
}

TriangleSet nine_cell_straddlers(std::size_t count) {
  // The triangles are flat enough that none meets the plate, where the integral would diverge.
  constexpr double size_over_height = 2, height_share = 0.3;
  Random random;
  std::vector<Triangle> triangles(count);
  for (Triangle& triangle : triangles) {
    const Vector3d centre = random.in_box({Vector3d{0.03, 0.03, 0.1}, Vector3d{0.07, 0.07, 0.2}});
    triangle = triangle_about(random, centre, size_over_height * centre.z());
    for (Vector3d& vertex : triangle)
      vertex.z() = centre.z() + height_share * (vertex.z() - centre.z());
  }
  return {"straddling_nine_cells", triangles};
}

TriangleSet closed_mesh(int segments) {
  std::vector<Triangle> triangles = triangulate(Sphere{1, segments});
  const Vector3d half_axes(0.15, 0.1, 0.08), centre(0.06, 0.04, 0.13);
  for (Triangle& triangle : triangles)
    for (Vector3d& vertex : triangle)
      vertex = centre + half_axes.cwiseProduct(vertex);
  return {"closed_mesh", triangles};
}

}  // namespace fringe::benchmarks
