#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fringe {

/// The three vertices of a triangle in metres, anticlockwise seen from outside the body it bounds.
using Triangle = std::array<Eigen::Vector3d, 3>;

/// Returns twice the area of a triangle (m²), exactly 0 if two vertices coincide. Accurate for slivers, too.
double twice_area(const Triangle& triangle);

/// Returns the sum of the areas (m²).
double area(std::span<const Triangle> triangles);

/// Returns the volume (m³) that a closed surface encloses, positive if its triangles are anticlockwise seen
/// from outside.
double signed_volume(std::span<const Triangle> triangles);

/// Tests whether the triangles bound a volume: whether every edge is used as often in one direction as in the
/// other. Vertices are the same if their coordinates are.
bool is_closed(std::span<const Triangle> triangles);

/// Returns the smallest box with sides along the axes that contains the triangles; empty (in Eigen's sense)
/// if there are none.
Eigen::AlignedBox3d axis_aligned_box(std::span<const Triangle> triangles);

/// What makes two triangles with the same vertices the same.
enum class Sides {
  alike,    ///< a triangle has no outward side: the order of the vertices does not count
  distinct  ///< the outward side counts
};

/// Returns the triangles without those that repeat an earlier one, in their order.
std::vector<Triangle> without_duplicates(std::vector<Triangle> triangles, Sides sides = Sides::alike);

}  // namespace fringe
