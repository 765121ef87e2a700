#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Bounding volumes of sets of vertices (thesis chapter 3; model/NUMERICS.md, section 13). Lengths are in the
/// unit of the vertices. Every function of vertices throws InputError if there are none or one is not finite.
namespace fringe {

struct BoundingSphere {
  Eigen::Vector3d centre;
  double radius;
};

/// The points centre + Σ tᵢ·half_widths[i]·axes.row(i) with |tᵢ| ≤ 1.
struct OrientedBox {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;  ///< rows; orthonormal up to rounding and right-handed
  Eigen::Vector3d half_widths;
};

/// A triangle of a mesh, given by the indices of its vertices.
using Face = std::array<std::size_t, 3>;

/// The method that finds the axes of an oriented box.
enum class BoxMethod {
  vertices,   ///< eigenvectors of the covariance of the vertices (thesis 3.1.4.1)
  triangles,  ///< eigenvectors of the covariance of the surface (thesis 3.1.4.2); `vertices` if it has no
              ///< area
  tight       ///< found by a search for the smallest volume
};

/// Reads "vertices", "triangles" or "tight"; throws InputError for anything else.
BoxMethod parse_box_method(std::string_view text);

/// Computes the smallest sphere (up to rounding) that contains all vertices strictly, whatever is rounded.
BoundingSphere bounding_sphere(std::span<const Eigen::Vector3d> vertices);

/// Computes the smallest box with sides along the axes. No rounding occurs: its sides pass exactly through
/// vertices.
Eigen::AlignedBox3d axis_aligned_box(std::span<const Eigen::Vector3d> vertices);

/// Computes a box that contains all vertices strictly, whatever is rounded; so even the box of one point has
/// half-widths above zero. The methods `triangles` and `tight` use the faces; `tight` also works without any.
/// Throws InputError for a face with an index out of range.
OrientedBox oriented_box(std::span<const Eigen::Vector3d> vertices, std::span<const Face> faces,
                         BoxMethod method);

/// Tests whether two closed volumes have a point in common. False is never wrong; where rounding could have
/// made it wrong the result is true. For axis-aligned boxes the test is exact.
bool overlap(const BoundingSphere& a, const BoundingSphere& b);
bool overlap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b);

/// Tests two boxes by the fifteen separating axes of S. Gottschalk, M. C. Lin and D. Manocha, SIGGRAPH 1996,
/// 171. The axes of the boxes must be orthonormal to 1e-14.
bool overlap(const OrientedBox& a, const OrientedBox& b);

/// Tests volumes of two kinds in the same way.
bool overlap(const BoundingSphere& sphere, const Eigen::AlignedBox3d& box);
bool overlap(const BoundingSphere& sphere, const OrientedBox& box);
bool overlap(const Eigen::AlignedBox3d& a, const OrientedBox& b);

}  // namespace fringe
