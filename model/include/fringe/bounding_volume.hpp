#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Bounding volumes of sets of vertices (thesis chapter 3; model/NUMERICS.md, section 13). Lengths are in the
/// unit of the vertices. Every function of vertices throws InputError for none and for one that is not
/// finite.
namespace fringe {

struct BoundingSphere {
  Eigen::Vector3d centre;
  double radius;
};

/// The points centre + Σ tᵢ·half_widths[i]·axes.row(i) with |tᵢ| ≤ 1.
struct OrientedBox {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;  ///< rows; orthonormal to rounding and right-handed
  Eigen::Vector3d half_widths;
};

/// A triangle of a mesh, by the indices of its vertices.
using Face = std::array<std::size_t, 3>;

/// How the axes of an oriented box are found.
enum class BoxMethod {
  vertices,   ///< eigenvectors of the covariance of the vertices (thesis 3.1.4.1)
  triangles,  ///< eigenvectors of the covariance of the surface (thesis 3.1.4.2); without area, as `vertices`
  tight       ///< searched for the smallest volume
};

/// "vertices", "triangles" or "tight"; throws InputError for anything else.
BoxMethod parse_box_method(std::string_view text);

/// The smallest sphere (to rounding) that holds all vertices strictly, whatever is rounded.
BoundingSphere bounding_sphere(std::span<const Eigen::Vector3d> vertices);

/// The smallest box with sides along the axes. It needs no rounding: vertices on its sides are on its sides.
Eigen::AlignedBox3d axis_aligned_box(std::span<const Eigen::Vector3d> vertices);

/// A box around all vertices that holds them strictly, whatever is rounded; so even the box of one point has
/// half-widths above zero. The faces are looked at by the methods `triangles` and `tight`, which also does
/// without. Throws InputError for a face with an index out of range.
OrientedBox oriented_box(std::span<const Eigen::Vector3d> vertices, std::span<const Face> faces,
                         BoxMethod method);

/// Whether two closed volumes have a point in common. Never a wrong "no"; where rounding could have made it
/// one the answer is yes. For AABBs the answer is exact.
bool overlap(const BoundingSphere& a, const BoundingSphere& b);
bool overlap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b);

/// By the fifteen separating axes of S. Gottschalk, M. C. Lin and D. Manocha, SIGGRAPH 1996, 171. The axes of
/// the boxes must be orthonormal to 1e-14.
bool overlap(const OrientedBox& a, const OrientedBox& b);

/// Volumes of two kinds.
bool overlap(const BoundingSphere& sphere, const Eigen::AlignedBox3d& box);
bool overlap(const BoundingSphere& sphere, const OrientedBox& box);
bool overlap(const Eigen::AlignedBox3d& a, const OrientedBox& b);

}  // namespace fringe
