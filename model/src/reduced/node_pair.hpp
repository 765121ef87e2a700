#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/box_self_interaction.hpp"
#include "geometry/wrench.hpp"
#include "reduced/node_forces.hpp"
#include "reduced/node_kernels.hpp"
#include "reduced/prepared_shape.hpp"

/// Quadrature between two bodies (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// A prepared shape at a pose: its point p is at centre + axes·(scale·p).
struct PlacedBody {
  const PreparedShape* shape;
  double scale;
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;
};

/// Returns the ends of a plate's or box's edges, relative to an origin.
std::vector<std::array<Eigen::Vector3d, 2>> placed_edges(const PlacedBody& body,
                                                         const Eigen::Vector3d& origin);

/// The natural logarithms by which the quadratures have to reduce the error.
struct QuadratureDigits {
  double outer;
  double inner;
};

/// The smoothness of the potential on a face: the logarithm of the parameter of the narrowest ellipse about
/// each direction that touches a singularity. Inside, the potential is analytic.
struct FaceSmoothness {
  double u;
  double v;
};

using BodySmoothness = std::array<FaceSmoothness, box_faces>;

/// The smoothness on two bodies' faces, which the other body's edges limit.
struct PairSmoothness {
  BodySmoothness a;
  BodySmoothness b;
};

/// Computes the smoothness on the faces of two bodies that are at least `gap` apart.
PairSmoothness smoothness(const PlacedBody& a, const PlacedBody& b, double gap);

/// Returns the least value of all faces and directions.
double least(const BodySmoothness& smoothness, std::size_t faces);

/// Computes the smoothness on a body's faces for singularities at points, whose coordinates are relative to
/// an origin.
BodySmoothness smoothness_at(const PlacedBody& body, std::span<const NodePoints> points,
                             const Eigen::Vector3d& origin);

/// The nodes of a body's faces, with the charges and potentials there.
struct NodeSide {
  std::vector<NodeGrid> grids;  ///< for each face
  std::ptrdiff_t functions = 0;
  std::ptrdiff_t count = 0;
  std::vector<float> x, y, z, charges, potentials;

  NodePoints points() const { return {x.data(), y.data(), z.data(), count}; }

  /// Chooses the rules of all faces for so many functions along each direction, and returns the number of
  /// nodes. `digits` is the logarithm of the error reduction to reach; where a rule would need more than
  /// `most` points, `missing` grows to the part that is not reached.
  std::ptrdiff_t choose_grids(const PlacedBody& body, int functions_along, const BodySmoothness& smooth,
                              double digits, int most, double& missing);
  /// Computes the nodes of the grids, relative to an origin.
  void lay(const PlacedBody& body, const Eigen::Vector3d& origin);
  /// Computes the charges at the nodes from the coefficients of the functions.
  void spread(const float* coefficients);
  /// Returns the nodes with the charges by several columns of coefficients.
  ChargedNodes charged(const Eigen::MatrixXf& coefficients);
  /// Computes the moments of the potentials at the nodes, in whole blocks.
  void gather(float* moments) const;
};

/// Returns the error of the potentials, relative to the largest, for so many digits.
double error_left(double inner_digits);

class MeshPair;

/// The nodes of two bodies, and the matrix of 1/distance between them.
class NodePair {
 public:
  NodePair();
  ~NodePair();
  NodePair(NodePair&&) noexcept;
  NodePair& operator=(NodePair&&) noexcept;
  NodePair(const NodePair&) = delete;
  NodePair& operator=(const NodePair&) = delete;

  /// Chooses the nodes for two placed bodies at least `gap` apart. `a_smoothness` is that on a's faces,
  /// limited by b. The numbers of functions are those along every direction of each face, or of all functions
  /// of a body of triangles.
  void place(const PlacedBody& a, const BodySmoothness& a_smoothness, int functions_a, const PlacedBody& b,
             const BodySmoothness& b_smoothness, int functions_b, double gap, QuadratureDigits digits);

  /// Computes the moments on both bodies of the potentials of charges on the other. Charges are coefficients
  /// of the bodies' functions; arrays are in whole blocks, zero beyond the last.
  void potentials(const float* charges_a, const float* charges_b, float* moments_a, float* moments_b);

  /// Computes the derivatives of energies between both bodies as the first moves, as node_forces() does, by
  /// charges in whole blocks (rows); torques are about the origin.
  std::vector<Wrench> forces(const Eigen::MatrixXf& charges_a, const Eigen::MatrixXf& charges_b);

  /// Returns true if a rule would need more points than it may have.
  bool is_cut_short() const { return is_cut_short_; }

  /// Returns an estimate of the potentials' error, relative to the largest.
  double relative_error() const { return relative_error_; }

 private:
  std::unique_ptr<MeshPair> mesh_;  ///< if a body consists of triangles
  bool a_is_outer_ = true;
  std::array<NodeSide, 2> sides_;  ///< the outer one first
  std::vector<float> matrix_;
  Eigen::Vector3d centre_;  ///< of the inner body, from which the nodes are counted
  double relative_error_ = 0;
  bool is_cut_short_ = false;
};

}  // namespace fringe::detail
