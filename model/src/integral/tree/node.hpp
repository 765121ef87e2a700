#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle_batch.hpp"
#include "integral/batch/chunks.hpp"
#include "integral/tree/monomials.hpp"

/// What the tree over a surface stores (model/NUMERICS.md, section 11).
namespace fringe::detail {

/// The points of quadratures.
struct PointArrays {
  std::vector<double> x, y, z, weight;
};

/// A symmetric matrix: xx, yy, zz, yz, zx, xy.
struct SymmetricMatrix {
  std::array<double, 6> entries{};

  /// nᵀSn.
  double along(const Eigen::Vector3d& n) const {
    return entries[0] * n.x() * n.x() + entries[1] * n.y() * n.y() + entries[2] * n.z() * n.z() +
           2 * (entries[3] * n.y() * n.z() + entries[4] * n.z() * n.x() + entries[5] * n.x() * n.y());
  }
};

/// The degrees of the quadratures of every node, from few points to many: a small node far away needs few.
/// That of degree 1 is the node's centre.
constexpr std::array<int, 4> quadrature_degrees{1, 2, 3, highest_degree};

/// A number for each quadrature of a node.
using PerQuadrature = std::array<double, quadrature_degrees.size()>;

/// What bounds the errors of a node's quadratures Σ w f(p) for ∫ f dA, in units of the node's area and of
/// powers of its radius: numbers that neither overflow nor vanish whatever the size of the surface. δ is the
/// distance of a point from the node's centre.
struct QuadratureErrors {
  /// By degree k: how far the quadrature is from the integral, at most, for the form of degree k in the
  /// expansion of 1/distance.
  std::array<PerQuadrature, moment_degree + 1> mismatch{};
  PerQuadrature remainder{};  ///< at least ∫|δ|⁷ dA + Σ|w||δ|⁷
};

/// A quadrature of degree 2 for each triangle of a leaf, with what bounds the sum of their errors, in units
/// as above. Here δ is the distance from the centroid of the point's own triangle.
struct TrianglewiseErrors {
  double reach = 0;           ///< m; the largest distance of a centroid from the node's centre
  double largest_radius = 0;  ///< m; the largest |δ|
  double mismatch = 0;        ///< for the form of degree 3
  double remainder = 0;       ///< ∫|δ|⁴ dA + Σ w|δ|⁴
};

/// The outward normals of all triangles make an angle with the axis whose cosine is at least this; −1 says
/// nothing.
struct NormalCone {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double cosine = -1;
};

constexpr std::size_t no_child = 0;  // the root is nobody's child

struct Node {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;  ///< of a sphere about the centre that holds the triangles and the quadratures' points
  double area = 0;
  Range triangles;                     ///< in the tree's order
  std::size_t first_child = no_child;  ///< the second follows it
  double smallest_remainder = 0;       ///< of the quadratures' errors: with it most nodes too near are told
  TrianglewiseErrors trianglewise{};   ///< of leaves
  QuadratureErrors errors{};
  std::array<Range, quadrature_degrees.size()> quadratures{};
  /// In units of the area times the radius squared: nᵀSn ≥ ∫(n·δ)² dA, and for each quadrature ≥ Σ w (n·δ)²
  /// over the positive weights and over the others.
  SymmetricMatrix second_moment{};
  NormalCone normals{};
};

/// How many points of `triangle_points` belong to each triangle.
constexpr std::size_t points_per_triangle = 3;

/// The tree: nodes with parents before children, the triangles that have an area in an order in which every
/// node's are consecutive.
struct SurfaceNodes {
  std::vector<Node> nodes;
  TriangleBatch triangles;
  PointArrays points;           ///< of the nodes' quadratures
  PointArrays triangle_points;  ///< of the triangles, in their order
};

}  // namespace fringe::detail
