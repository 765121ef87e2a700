#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// The triangles that run times and instruction counts are measured on.
namespace fringe::benchmarks {

/// The sensor of all sets: 10 cm × 10 cm in z = 0.
Rectangle measured_plate();

struct TriangleSet {
  std::string name;
  std::vector<Triangle> triangles;
};

/// The thesis' regions, by the plate's nearest feature.
enum class Region { face, edge, corner };

/// Triangles that lie in one cell, their size a fixed share of their distance from the plate: 0.02 for a fine
/// mesh, 0.3 for a coarse one. Named I_fine, II_coarse and so on.
TriangleSet fine_triangles(Region region, std::size_t count);
TriangleSet coarse_triangles(Region region, std::size_t count);

/// What a fine mesh has along the border planes: triangles of a size from 0.02 to 0.1 of their distance, with
/// their centroid in a border plane, half of them between the regions I and II, half between II and III.
TriangleSet small_straddlers(std::size_t count);

/// Triangles larger than the plate and above it, which reach into up to nine cells.
TriangleSet nine_cell_straddlers(std::size_t count);

/// A closed mesh of segments·(segments − 2) triangles, an ellipsoid in front of the plate and larger than it,
/// so that all nine cells are met. `segments` is even.
TriangleSet closed_mesh(int segments);

}  // namespace fringe::benchmarks
