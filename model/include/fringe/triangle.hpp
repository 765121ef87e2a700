#pragma once

#include <array>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fringe {

/// The three vertices of a triangle in metres, anticlockwise seen from outside the body it bounds.
using Triangle = std::array<Eigen::Vector3d, 3>;

/// Twice the area of a triangle (m²), exactly 0 when two vertices coincide. Keeps its digits for slivers.
double twice_area(const Triangle& triangle);

/// The sum of the areas (m²).
double area(std::span<const Triangle> triangles);

/// The volume (m³) a closed surface encloses, positive when its triangles are anticlockwise seen from
/// outside.
double signed_volume(std::span<const Triangle> triangles);

/// True when every edge is used as often in one direction as in the other, so that the triangles bound a
/// volume. Vertices are the same when their coordinates are.
bool is_closed(std::span<const Triangle> triangles);

/// The smallest box with sides along the axes that holds the triangles; empty (Eigen's meaning) for no
/// triangles.
Eigen::AlignedBox3d axis_aligned_box(std::span<const Triangle> triangles);

}  // namespace fringe
