#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"
#include "surface/face.hpp"

/// The single-layer interaction of a rectangular face with itself (model/BOUNDARY_ELEMENTS.md, section 3).
namespace fringe::detail {

/// The pairs i ≤ k < functions whose sum is even, in the order (0,0), (1,1), (0,2), (2,2), (1,3), …: the
/// pairs for fewer functions come first.
class EvenPairs {
 public:
  explicit EvenPairs(int functions);
  Eigen::Index size() const { return static_cast<Eigen::Index>(pairs_.size()); }
  std::pair<int, int> operator[](Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)]; }
  /// Returns the position of (i, k), in either order; i + k must be even.
  static Eigen::Index index(int i, int k);

 private:
  std::vector<std::pair<int, int>> pairs_;
};

/// A quadrature rule for the distance, in half sides, of two points of a face along a direction, or of a
/// point from an edge. Its nodes are dense at the distance 0.
struct DistanceRule {
  /// `more_points` scales the numbers of points of all quadratures, to measure their errors.
  DistanceRule(EdgeKind edge, int functions, double more_points = 1);

  Eigen::ArrayXd distance;  ///< the nodes, in [0, 2]
  /// (even pairs, nodes): weight·A_ik(u), with the autocorrelations A_ik(u) = ∫f_i(x)·f_k(x − u) dx
  Eigen::MatrixXd correlation;
  Eigen::MatrixXd function;  ///< (functions, nodes): weight·f_k(u − 1)
};

/// Returns the rule for so many functions, or one more. It is made by the first call that asks for it.
const DistanceRule& distance_rule(EdgeKind edge, int functions);

/// Computes ∫∫∫∫ f_i(x)f_j(y)·f_k(x')f_l(y')/√(a²(x − x')² + b²(y − y')² + distance²), the block of two equal
/// faces of half sides a and b, one straight above the other, or, for the distance 0, of a face with itself.
/// Rows are (i, j) and columns (k, l), with j and l running fastest.
Eigen::MatrixXd parallel_faces(const DistanceRule& rule, FaceFunctions first, FaceFunctions second, double a,
                               double b, double distance);

/// Computes the single-layer block of a face with itself.
Eigen::MatrixXd face_self_interaction(const ChargedFace& face, FaceFunctions functions);

}  // namespace fringe::detail
