#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "surface/face.hpp"

/// The edge-weighted (Jacobi) basis: functions (1 − x²)^α·p_k(x) on [−1, 1] that carry the charge, and
/// quadrature for them (model/BOUNDARY_ELEMENTS.md, section 2).
namespace fringe::detail {

double edge_exponent(EdgeKind edge);

/// Returns (1 − x²)^α, given the distances of x from both ends.
inline double edge_weight(EdgeKind edge, double from_left, double from_right) {
  return edge == EdgeKind::thin ? 1 / std::sqrt(from_left * from_right)
                                : 1 / std::cbrt(from_left * from_right);
}

/// Largest number of functions along one direction of a face.
constexpr int most_functions = 31;

/// The numbers of functions that a face has along its two directions.
struct FaceFunctions {
  int u;
  int v;
  int count() const { return u * v; }
  bool operator==(const FaceFunctions&) const = default;
};

/// Returns the number of functions of the coarse space along a direction; `functions` must be odd, 3 or more.
int coarse_functions(int functions);

/// Returns true if a face's function belongs to the coarse space.
bool is_coarse(FaceFunctions functions, int function);

/// The polynomials p_0, p_1, … orthonormal under the weight (1 − x²)^α. Only p_0 carries a net charge.
class WeightedPolynomials {
 public:
  explicit WeightedPolynomials(EdgeKind edge);

  /// Evaluates p_0(x) to p_{count−1}(x).
  void evaluate(double x, int count, double* values) const {
    values[0] = first_;
    double before = 0;
    for (int k = 1; k < count; ++k) {
      const double next = (x * values[k - 1] - before) * inverse_[static_cast<std::size_t>(k)];
      before = offdiagonal_[static_cast<std::size_t>(k)] * values[k - 1];
      values[k] = next;
    }
  }

  /// Returns ∫(1 − x²)^α·p_0(x) dx.
  double net_charge() const { return 1 / first_; }

 private:
  double first_;
  std::vector<double> offdiagonal_;
  std::vector<double> inverse_;
};

const WeightedPolynomials& weighted_polynomials(EdgeKind edge);

/// A quadrature rule on [−1, 1] with the weight function (1 − x)^right·(1 + x)^left.
struct JacobiRule {
  Eigen::VectorXd nodes;
  Eigen::VectorXd weights;
};

/// Computes the Gauss rule of the given number of points (Golub and Welsch).
JacobiRule jacobi_rule(int points, double right, double left);

/// A quadrature rule along one direction of a face, with the functions' values contained in the weights.
struct DirectionRule {
  Eigen::VectorXd nodes;  ///< in [−1, 1]
  /// (functions, nodes): weight·(1 − x²)^α·p_k(x). There may be more rows, up to a whole face_block.
  Eigen::MatrixXd weights;
};

/// Largest number of points of a rule on the whole of [−1, 1]; an integral that needs more is divided into
/// panels.
constexpr int most_points = 64;

/// Returns the rule with so many points on the whole of [−1, 1], for most_functions functions.
const DirectionRule& whole_rule(EdgeKind edge, int points);

/// Adds to a rule the nodes of the panel [from, to], on which the integrand apart from weight and polynomials
/// is smooth. The rule must have room for `points` more nodes from `offset` on.
void add_panel(DirectionRule& rule, Eigen::Index offset, EdgeKind edge, int functions, double from, double to,
               int points);

/// The tanh-sinh rule on [0, 1], for integrands with any singularities at the ends (Takahasi and Mori 1974).
/// It gives the distances from both ends: one cannot be computed from the other without loss of accuracy.
struct TanhSinhRule {
  std::vector<double> from_left;
  std::vector<double> from_right;
  std::vector<double> weights;
};

/// Computes the rule of so many points, equidistant in its variable t from −reach to reach.
TanhSinhRule tanh_sinh_rule(int points, double reach);

}  // namespace fringe::detail
