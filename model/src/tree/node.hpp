#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle_batch.hpp"
#include "monomials.hpp"

/// What the tree over a surface stores (model/NUMERICS.md, section 11).
namespace fringe::detail {

/// Consecutive elements.
struct Range {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// The points of all quadratures.
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

/// A quadrature Σ w f(p) for ∫ f dA over a node, with what bounds its error. δ is the distance of a point
/// from the node's centre.
struct Quadrature {
  Range points;
  int degree = 0;
  double remainder = 0;  ///< ∫|δ|^(degree+1) dA + Σ|w||δ|^(degree+1)
  /// By degree k: how far the quadrature is from the integral, at most, for a form of degree k that does not
  /// exceed |δ|ᵏ.
  std::array<double, highest_degree + 1> mismatch{};
};

/// The degrees of the quadratures of every node: a small node far away needs few points.
constexpr std::array<int, 3> quadrature_degrees{2, 3, highest_degree};

/// One quadrature of degree 2 for each triangle of a leaf, with what bounds the sum of their errors. Here δ
/// is the distance from the centroid of the point's own triangle.
struct TrianglewiseQuadrature {
  Range points;
  double remainder = 0;           ///< ∫|δ|³ dA + Σ w|δ|³
  double reach = 0;               ///< the largest distance of a centroid from the node's centre
  double largest_radius = 0;      ///< the largest |δ|
  SymmetricMatrix second_moment;  ///< ∫ δδᵀ dA = Σ w δδᵀ
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
  double radius = 0;  ///< of a sphere about the centre that holds the triangles and the quadrature's points
  double area = 0;
  double squared_radius_moment = 0;                                 ///< ∫|δ|² dA
  Range triangles;                                                  ///< in the tree's order
  std::size_t first_child = no_child;                               ///< the second follows it
  std::array<Quadrature, quadrature_degrees.size()> quadratures{};  ///< from few points to many
  /// nᵀSn ≥ ∫(n·δ)² dA, and for each quadrature ≥ Σ w (n·δ)² over the positive weights and over the others.
  SymmetricMatrix second_moment{};
  TrianglewiseQuadrature trianglewise{};  ///< of leaves
  NormalCone normals{};
};

/// The tree: nodes with parents before children, the triangles that have an area in an order in which every
/// node's are consecutive.
struct SurfaceNodes {
  std::vector<Node> nodes;
  TriangleBatch triangles;
  PointArrays points;
};

}  // namespace fringe::detail
