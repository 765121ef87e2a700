#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// The sets of triangles on which run times and instruction counts are measured.
namespace fringe::benchmarks {

/// Returns the sensor of all sets: 10 cm × 10 cm in z = 0.
Rectangle measured_plate();

struct TriangleSet {
  std::string name;
  std::vector<Triangle> triangles;
};

/// The thesis' regions, named by the nearest feature of the plate.
enum class Region { face, edge, corner };

/// Makes triangles that lie in one cell, their size a fixed fraction of their distance from the plate: 0.02
/// for a fine mesh, 0.3 for a coarse one. The sets are named I_fine, II_coarse and so on.
TriangleSet fine_triangles(Region region, std::size_t count);
TriangleSet coarse_triangles(Region region, std::size_t count);

/// Makes triangles as a fine mesh has them along the cells' borders: sizes from 0.02 to 0.1 of their
/// distance, with their centroid in a border plane, half of them between the regions I and II, half between
/// II and III.
TriangleSet small_straddlers(std::size_t count);

/// Makes triangles above the plate and larger than it, which reach into up to nine cells.
TriangleSet nine_cell_straddlers(std::size_t count);

/// Makes a closed mesh of segments·(segments − 2) triangles: an ellipsoid in front of the plate and larger
/// than it, which meets all nine cells. `segments` must be even.
TriangleSet closed_mesh(int segments);

}  // namespace fringe::benchmarks
