#pragma once

#include <cstddef>
#include <span>

#include "fringe/triangle.hpp"

namespace fringe {

/// The number of each defect of a triangle mesh. Vertices are the same if their coordinates are. Edges,
/// vertices and pairs are counted without the triangles that have no area or are duplicates.
struct MeshDefects {
  std::size_t without_area = 0;  ///< triangles of area 0
  std::size_t duplicates = 0;    ///< triangles with the same three vertices as an earlier one, in any order
  std::size_t open_edges = 0;    ///< edges of one triangle: the outlines of holes and of sheets
  std::size_t branching_edges = 0;  ///< edges of more than two triangles
  std::size_t flipped_edges = 0;    ///< edges of two triangles whose outward sides disagree
  std::size_t t_junctions = 0;      ///< vertices inside an open edge, to 1e-9 of the edge's length
  std::size_t crossings = 0;  ///< pairs of triangles without a common vertex that have a point in common
  std::size_t shells = 0;     ///< parts that are connected through edges; one is no defect
};

/// Counts the defects of a triangle mesh; which triangles cross is decided exactly. Triangles with a
/// coordinate that is not finite are refused with an InputError.
MeshDefects mesh_defects(std::span<const Triangle> triangles);

}  // namespace fringe
