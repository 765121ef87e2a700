#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

/// The division of the faces of meshes, polygons of three or more corners in space, into triangles, in the
/// order that geometries/SCENE.md fixes. A face is seen along the axis in which the areas of its fan are
/// largest: that leaves its other two coordinates as they are, so that every decision about the outline is
/// exact.
namespace fringe::detail {

/// What is remarkable about the faces of a mesh.
struct FaceDefects {
  std::size_t bent = 0;      ///< number of faces whose corners are not in a plane
  double bend = 0;           ///< how far these are from being in a plane, at most, in the mesh's unit
  std::size_t crossing = 0;  ///< number of faces whose outline crosses itself
};

/// Appends the triangles of a face of three or more finite corners, and counts its defects.
void append_face(std::vector<Triangle>& triangles, std::span<const Eigen::Vector3d> corners,
                 FaceDefects& defects);

/// Returns sentences on the defects; `scale` is the mesh's unit in metres.
std::vector<std::string> remarks_on_faces(const FaceDefects& defects, double scale);

}  // namespace fringe::detail
