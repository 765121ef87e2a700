#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/box_self_interaction.hpp"
#include "reduced/node_kernels.hpp"
#include "reduced/prepared_shape.hpp"

/// Quadrature between two bodies (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// A prepared shape somewhere: the point p of the shape is at centre + axes·(scale·p).
struct PlacedBody {
  const PreparedShape* shape;
  double scale;
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;
};

/// The ends of a plate's or box's edges, seen from an origin.
std::vector<std::array<Eigen::Vector3d, 2>> placed_edges(const PlacedBody& body,
                                                         const Eigen::Vector3d& origin);

/// How many powers of e the quadratures are to win from their points.
struct QuadratureDigits {
  double outer;
  double inner;
};

/// The logarithm of the parameter of the narrowest ellipse about a face's direction outside of which the
/// potential is analytic.
struct FaceSmoothness {
  double u;
  double v;
};

using BodySmoothness = std::array<FaceSmoothness, box_faces>;

/// Of two bodies' faces, by the other's edges.
struct PairSmoothness {
  BodySmoothness a;
  BodySmoothness b;
};

/// No point of one body is nearer to the other than `gap`.
PairSmoothness smoothness(const PlacedBody& a, const PlacedBody& b, double gap);

/// The least of all faces and directions.
double least(const BodySmoothness& smoothness, std::size_t faces);

/// The nodes of a body's faces, and charges and potentials there.
struct NodeSide {
  std::vector<NodeGrid> grids;  ///< of each face
  std::ptrdiff_t functions = 0;
  std::ptrdiff_t count = 0;
  std::vector<float> x, y, z, charges, potentials;

  NodePoints points() const { return {x.data(), y.data(), z.data(), count}; }

  /// Lays the nodes of the grids, seen from an origin.
  void lay(const PlacedBody& body, const Eigen::Vector3d& origin);
  void spread(const float* coefficients);
  void gather(float* moments) const;
};

/// The rules of all faces of a body as seen from points whose coordinates begin at an origin. `digits` are to
/// be won; where a rule would need more points than it may have, `missing` grows to those that are not.
void choose_grids(NodeSide& side, const PlacedBody& body, int functions, std::span<const NodePoints> points,
                  const Eigen::Vector3d& origin, double digits, double& missing);

/// What digits leave of the potentials, relative to the largest.
double error_left(double inner_digits);

class MeshPair;

/// Two bodies' nodes, and 1/distance between them.
class NodePair {
 public:
  NodePair();
  ~NodePair();
  NodePair(NodePair&&) noexcept;
  NodePair& operator=(NodePair&&) noexcept;
  NodePair(const NodePair&) = delete;
  NodePair& operator=(const NodePair&) = delete;

  /// `a_smoothness`: of a as seen from b; functions: along every direction of each face, or
  /// of all of a body of triangles.
  void place(const PlacedBody& a, const BodySmoothness& a_smoothness, int functions_a, const PlacedBody& b,
             const BodySmoothness& b_smoothness, int functions_b, QuadratureDigits digits);

  /// The moments on both bodies of the potentials of charges on the other, all as coefficients of the faces'
  /// functions; in whole blocks, zero beyond the last.
  void potentials(const float* charges_a, const float* charges_b, float* moments_a, float* moments_b);

  /// Whether a rule would need more points than it may have.
  bool is_cut_short() const { return is_cut_short_; }

  /// An estimate of the potentials' error, relative to the largest.
  double relative_error() const { return relative_error_; }

 private:
  std::unique_ptr<MeshPair> mesh_;  ///< if a body is of triangles
  bool a_is_outer_ = true;
  std::array<NodeSide, 2> sides_;  ///< the outer one first
  std::vector<float> matrix_;
  double relative_error_ = 0;
  bool is_cut_short_ = false;
};

}  // namespace fringe::detail
