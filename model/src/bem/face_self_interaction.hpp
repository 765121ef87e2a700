#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"

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

/// Computes the autocorrelations A_ik(u) = ∫f_i(x)·f_k(x − u) dx for 0 < u < 2, one for each even pair of so
/// many functions, by a quadrature rule over the x of the overlap. `rest` is 2 − u.
Eigen::VectorXd correlations(EdgeKind edge, const EvenPairs& pairs, int functions, double u, double rest,
                             const TanhSinhRule& overlap);

/// Returns a rule that suffices for the correlations of so many functions.
TanhSinhRule overlap_rule(int functions);

/// The cached self-interaction of faces of any size with one kind of edge.
class FaceSelfInteraction {
 public:
  /// Evaluates the table. `more_points` scales the numbers of points of all quadratures, to measure their
  /// errors.
  FaceSelfInteraction(EdgeKind edge, int functions, double more_points = 1);

  /// Returns ∫∫∫∫ f_i(x)f_j(y)·f_k(x')f_l(y')/√(a²(x − x')² + b²(y − y')²), rows (i, j) and columns (k, l)
  /// with j and l running fastest; `a` and `b` are half the face's sides.
  Eigen::MatrixXd matrix(int functions_u, int functions_v, double a, double b) const;

 private:
  std::vector<double> slopes_;            ///< t: the nodes of the integral over v/u
  std::vector<Eigen::MatrixXd> moments_;  ///< weight·∫A_p(u)·A_q(ut) du for every t
};

/// Returns the table for at least so many functions. It is made by the first call that asks for it.
const FaceSelfInteraction& face_self_interaction(EdgeKind edge, int functions);

}  // namespace fringe::detail
