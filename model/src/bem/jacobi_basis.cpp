#include "bem/jacobi_basis.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "bem/charge_kernels.hpp"
#include "numeric/parallel.hpp"

namespace fringe::detail {
namespace {

/// Returns the integral of (1 − x)^right·(1 + x)^left over [−1, 1].
double jacobi_mass(double right, double left) {
  return std::exp2(right + left + 1) * std::tgamma(right + 1) * std::tgamma(left + 1) /
         std::tgamma(right + left + 2);
}

/// Returns the square of the k-th off-diagonal element of the Jacobi matrix, k ≥ 1.
double squared_offdiagonal(int k, double right, double left) {
  const double sum = right + left, twice = 2 * k + sum;
  if (k == 1)
    return 4 * (1 + right) * (1 + left) / ((2 + sum) * (2 + sum) * (3 + sum));
  return 4 * k * (k + right) * (k + left) * (k + sum) / (twice * twice * (twice + 1) * (twice - 1));
}

double diagonal(int k, double right, double left) {
  if (right == left)
    return 0;
  const double twice = 2 * k + right + left;
  return k == 0 ? (left - right) / (twice + 2) : (left * left - right * right) / (twice * (twice + 2));
}

/// The ends of [−1, 1] that a panel touches.
enum class Touches { none, left, right };

/// Returns the rule for panels that touch an end.
const JacobiRule& panel_rule(EdgeKind edge, Touches touches, int points) {
  static std::array<std::array<LazyArray<JacobiRule, most_points>, 3>, 2> rules;
  const double exponent = edge_exponent(edge);
  return rules[static_cast<std::size_t>(edge)][static_cast<std::size_t>(touches)].at(
      static_cast<std::size_t>(points - 1), [&] {
        return jacobi_rule(points, touches == Touches::right ? exponent : 0,
                           touches == Touches::left ? exponent : 0);
      });
}

DirectionRule make_whole_rule(EdgeKind edge, int points) {
  const double exponent = edge_exponent(edge);
  const JacobiRule rule = jacobi_rule(points, exponent, exponent);
  DirectionRule result{rule.nodes, Eigen::MatrixXd::Zero(whole_face_blocks(most_functions), points)};
  for (int i = 0; i < points; ++i) {
    weighted_polynomials(edge).evaluate(rule.nodes[i], most_functions, result.weights.col(i).data());
    result.weights.col(i) *= rule.weights[i];
  }
  return result;
}

}  // namespace

double edge_exponent(EdgeKind edge) {
  return edge == EdgeKind::thin ? -1.0 / 2 : -1.0 / 3;
}

int coarse_functions(int functions) {
  // Odd, as the number of functions is, so that symmetric functions are treated like antisymmetric ones.
  const int part = 18 * functions / 25;
  return part % 2 == 0 ? part - 1 : part;
}

bool is_coarse(FaceFunctions functions, int function) {
  return function / functions.v < coarse_functions(functions.u) &&
         function % functions.v < coarse_functions(functions.v);
}

WeightedPolynomials::WeightedPolynomials(EdgeKind edge)
    : first_(1 / std::sqrt(jacobi_mass(edge_exponent(edge), edge_exponent(edge)))), offdiagonal_{0}, inverse_{
                                                                                                         0} {
  const double exponent = edge_exponent(edge);
  for (int k = 1; k < most_functions; ++k) {
    offdiagonal_.push_back(std::sqrt(squared_offdiagonal(k, exponent, exponent)));
    inverse_.push_back(1 / offdiagonal_.back());
  }
}

const WeightedPolynomials& weighted_polynomials(EdgeKind edge) {
  static const WeightedPolynomials thin(EdgeKind::thin);
  static const WeightedPolynomials right_angle(EdgeKind::right_angle);
  return edge == EdgeKind::thin ? thin : right_angle;
}

JacobiRule jacobi_rule(int points, double right, double left) {
  Eigen::VectorXd diagonals(points), offdiagonals(std::max(points - 1, 0));
  for (int k = 0; k < points; ++k)
    diagonals[k] = diagonal(k, right, left);
  for (int k = 1; k < points; ++k)
    offdiagonals[k - 1] = std::sqrt(squared_offdiagonal(k, right, left));
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonals, offdiagonals);
  return {solver.eigenvalues(),
          jacobi_mass(right, left) * solver.eigenvectors().row(0).transpose().cwiseAbs2()};
}

const DirectionRule& whole_rule(EdgeKind edge, int points) {
  static std::array<LazyArray<DirectionRule, most_points>, 2> rules;
  return rules[static_cast<std::size_t>(edge)].at(static_cast<std::size_t>(points - 1),
                                                  [&] { return make_whole_rule(edge, points); });
}

void add_panel(DirectionRule& rule, Eigen::Index offset, EdgeKind edge, int functions, double from, double to,
               int points) {
  const Touches touches = from == -1 ? Touches::left : to == 1 ? Touches::right : Touches::none;
  const JacobiRule& panel = panel_rule(edge, touches, points);
  const double half = (to - from) / 2;
  const WeightedPolynomials& polynomials = weighted_polynomials(edge);
  for (int i = 0; i < points; ++i) {
    const double s = panel.nodes[i];
    const double from_left = (1 + from) + half * (1 + s), from_right = (1 - to) + half * (1 - s);
    // The rule contains the factor that is singular at the panel's end; the weight leaves it out.
    const double weight = touches == Touches::none   ? edge_weight(edge, from_left, from_right)
                          : touches == Touches::left ? edge_weight(edge, half, from_right)
                                                     : edge_weight(edge, from_left, half);
    rule.nodes[offset + i] = touches == Touches::right ? 1 - from_right : from_left - 1;
    double* values = rule.weights.col(offset + i).data();
    polynomials.evaluate(rule.nodes[offset + i], functions, values);
    for (int k = 0; k < functions; ++k)
      values[k] *= half * panel.weights[i] * weight;
  }
}

TanhSinhRule tanh_sinh_rule(int points, double reach) {
  TanhSinhRule rule;
  const double step = 2 * reach / (points - 1);
  for (int i = 0; i < points; ++i) {
    const double t = -reach + i * step, s = std::numbers::pi * std::sinh(t);
    const double from_left = 1 / (1 + std::exp(-s)), from_right = 1 / (1 + std::exp(s));
    rule.from_left.push_back(from_left);
    rule.from_right.push_back(from_right);
    rule.weights.push_back(step * std::numbers::pi * std::cosh(t) * from_left * from_right);
  }
  return rule;
}

}  // namespace fringe::detail
