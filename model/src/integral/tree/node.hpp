#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle_batch.hpp"
#include "integral/batch/chunks.hpp"
#include "integral/tree/moments.hpp"

/// The data structures of the tree over a surface (model/NUMERICS.md, section 11).
namespace fringe::detail {

/// Quadrature points and weights as a structure of arrays.
struct PointArrays {
  std::vector<double> x, y, z, weight;
};

/// A symmetric matrix with the entries xx, yy, zz, yz, zx, xy.
struct SymmetricMatrix {
  std::array<double, 6> entries{};

  /// Computes nᵀSn.
  double along(const Eigen::Vector3d& n) const {
    return entries[0] * n.x() * n.x() + entries[1] * n.y() * n.y() + entries[2] * n.z() * n.z() +
           2 * (entries[3] * n.y() * n.z() + entries[4] * n.z() * n.x() + entries[5] * n.x() * n.y());
  }
};

/// Degrees of the quadratures of every node, from few points to many: a small distant node needs few points.
/// The quadrature of degree 1 is the node's centre.
constexpr std::array<int, 4> quadrature_degrees{1, 2, 3, highest_degree};

/// One number per quadrature of a node.
using PerQuadrature = std::array<double, quadrature_degrees.size()>;

/// Bounds of the errors of a node's quadratures Σ w f(p) for ∫ f dA, in units of the node's area and of
/// powers of its radius, so that they neither overflow nor underflow whatever the size of the surface. δ is a
/// point's offset from the node's centre.
struct QuadratureErrors {
  /// Bound of the quadrature's error for the form of degree k in the Taylor expansion of 1/distance, by k.
  std::array<PerQuadrature, moment_degree + 1> mismatch{};
  PerQuadrature remainder{};  ///< upper bound of ∫|δ|⁷ dA + Σ|w||δ|⁷
};

/// Bounds of the summed errors of the quadratures of degree 2 on each triangle of a leaf, in units as above.
/// Here δ is a point's offset from the centroid of its own triangle.
struct TrianglewiseErrors {
  double reach = 0;           ///< m; the largest distance of a centroid from the node's centre
  double largest_radius = 0;  ///< m; the largest |δ|
  double mismatch = 0;        ///< bound for the form of degree 3
  double remainder = 0;       ///< ∫|δ|⁴ dA + Σ w|δ|⁴
};

/// A cone that contains the outward normals of all triangles: their angle with the axis has at least this
/// cosine. −1 is no restriction.
struct NormalCone {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double cosine = -1;
};

constexpr std::size_t no_child = 0;  // the index of the root, which is no node's child

struct Node {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;  ///< of a sphere about the centre with all triangles and quadrature points
  double area = 0;
  Range triangles;                     ///< range in the tree's order of triangles
  std::size_t first_child = no_child;  ///< index; the second child follows it
  double smallest_remainder = 0;       ///< of the quadratures; rejects most nodes that are too near
  TrianglewiseErrors trianglewise{};   ///< set for leaves only
  QuadratureErrors errors{};
  std::array<Range, quadrature_degrees.size()> quadratures{};
  /// Matrix S in units of the area times the radius squared. nᵀSn is at least ∫(n·δ)² dA and, for each
  /// quadrature, at least Σ |w| (n·δ)² over the positive weights, and over the negative ones.
  SymmetricMatrix second_moment{};
  NormalCone normals{};
};

/// Number of points in `triangle_points` per triangle.
constexpr std::size_t points_per_triangle = 3;

/// The tree: nodes, with parents before their children, and the triangles of positive area, ordered so that
/// every node's triangles are consecutive.
struct SurfaceNodes {
  std::vector<Node> nodes;
  TriangleBatch triangles;
  PointArrays points;           ///< points of the nodes' quadratures
  PointArrays triangle_points;  ///< points of the triangles' quadratures, in the triangles' order
};

}  // namespace fringe::detail
