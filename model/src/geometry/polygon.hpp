#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

/// Simple polygons in a plane. Every decision is exact: it is made in floating point where rounding cannot
/// change it, and otherwise in integers.
namespace fringe::detail {

/// Returns why these vertices, in their order, are not those of a simple polygon; nothing if they are.
std::optional<std::string> defect_of_polygon(std::span<const Eigen::Vector2d> vertices);

/// Divides a simple polygon into triangles in z = 0 with their normals along +z, by clipping ears in the
/// order that geometries/SCENE.md fixes. Throws InputError for a polygon with a defect.
std::vector<Triangle> triangles_of_polygon(std::span<const Eigen::Vector2d> vertices);

}  // namespace fringe::detail
