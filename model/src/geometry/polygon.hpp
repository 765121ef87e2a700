#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

/// Simple polygons in a plane, and the faces of meshes, which are polygons in space. Every decision is exact:
/// it is made in floating point where rounding cannot change it, and otherwise in integers.
namespace fringe::detail {

/// Returns 1 if the way from a over b to c turns left, −1 if it turns right, and 0 if the points lie on a
/// line.
int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

/// The indices of a triangle's corners in an outline.
using CornersOfEar = std::array<std::size_t, 3>;

/// The triangles of an outline, and the indices of what is left of one that is not simple; empty otherwise.
struct ClippedOutline {
  std::vector<CornersOfEar> ears;
  std::vector<std::size_t> rest;
};

/// Clips the ears of an outline of more than two vertices, given anticlockwise, in the order that
/// geometries/SCENE.md fixes. It may touch itself in vertices at one place, as one around a hole does.
ClippedOutline clip_ears(std::span<const Eigen::Vector2d> vertices);

/// Returns why these vertices, in their order, are not those of a simple polygon; nothing if they are.
std::optional<std::string> defect_of_polygon(std::span<const Eigen::Vector2d> vertices);

/// Divides a simple polygon into triangles in z = 0 with their normals along +z, by clipping ears in the
/// order that geometries/SCENE.md fixes. Throws InputError for a polygon with a defect.
std::vector<Triangle> triangles_of_polygon(std::span<const Eigen::Vector2d> vertices);

/// Remarks on the faces of a mesh.
struct FaceDefects {
  std::size_t bent = 0;      ///< number of faces whose corners are not in a plane
  double bend = 0;           ///< how far these are from being in a plane, at most, in the mesh's unit
  std::size_t crossing = 0;  ///< number of faces whose outline crosses itself
};

/// Appends the triangles of a face of three or more finite corners, in the order that geometries/SCENE.md
/// fixes, and counts its defects. A face is seen along the axis in which the areas of its fan are largest:
/// that leaves its other two coordinates as they are, so that every decision about the outline is exact.
void append_face(std::vector<Triangle>& triangles, std::span<const Eigen::Vector3d> corners,
                 FaceDefects& defects);

/// Returns sentences on the defects; `scale` is the mesh's unit in metres.
std::vector<std::string> remarks_on_faces(const FaceDefects& defects, double scale);

}  // namespace fringe::detail
