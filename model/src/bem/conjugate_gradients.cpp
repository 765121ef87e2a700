#include "bem/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bem/group_densities.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Limit of the number of steps. More are never needed: with the two-level preconditioner, every step reduces
/// the error by a factor of about three.
constexpr int most_iterations = 200;

/// Multiple of the accuracy below which a remaining decrement is small.
constexpr double almost_done = 30;

/// Leaves out the functions that depend on earlier ones: of which less than the fraction `dependence` of the
/// energy is left after orthogonalisation. `matrix` is the lower triangle; rows and columns of these
/// functions get zeros and a diagonal element that makes their coefficients vanish.
void leave_out_dependent(MatrixXd& matrix, double dependence) {
  constexpr double infinite = 1e30;
  MatrixXd factor = MatrixXd::Zero(matrix.rows(), matrix.cols());
  for (Index k = 0; k < matrix.rows(); ++k) {
    check_interruption();
    const Index rest = matrix.rows() - k;
    VectorXd column = matrix.col(k).tail(rest);
    column -= factor.bottomLeftCorner(rest, k) * factor.row(k).head(k).transpose();
    if (column[0] > dependence * matrix(k, k)) {
      factor.col(k).tail(rest) = column / std::sqrt(column[0]);
      continue;
    }
    matrix.row(k).head(k).setZero();
    matrix.col(k).tail(rest - 1).setZero();
    factor.row(k).head(k).setZero();
    matrix(k, k) *= infinite;
  }
}

/// Factorises a matrix, of which the lower triangle is read. Functions that depend on earlier ones are left
/// out if the tolerance of the quadratures is so fine that these are not the reason.
Cholesky factorised(MatrixXd matrix, double tolerance) {
  /// Tolerance of the quadratures above which a matrix that is not positive definite calls for better ones.
  constexpr double sufficient = 1e-5;
  /// Least energy that a function adds to earlier ones, relative to its own: of a panel between others it is
  /// about the ratio of the gap to the panel.
  constexpr double least_energy = 1e-6;
  Cholesky factor(matrix);
  const auto is_regular = [&] {
    return factor.is_positive_definite() &&
           (factor.factor().diagonal().array().square() > least_energy * matrix.diagonal().array()).all();
  };
  if (!is_regular() && tolerance <= sufficient) {
    leave_out_dependent(matrix, std::max(least_energy, 10 * tolerance));
    factor = Cholesky(std::move(matrix));
  }
  return factor;
}

/// One right-hand side.
struct Column {
  VectorXd charge;
  VectorXd residual;
  double decrement = 0;  ///< of the energy, by the last step
};

/// Runs preconditioned conjugate gradients from the column's charge and residual. Stops when a step lowers
/// the energy by less than `accuracy` times the charge's own. Returns false if the matrix is not positive
/// definite: the quadratures are too coarse.
bool conjugate_gradients(const PanelEquations& equations, const TwoLevelPreconditioner& preconditioner,
                         const VectorXd& net, double accuracy, Column& column) {
  VectorXd step = preconditioner.apply(column.residual);
  double product = column.residual.dot(step);
  for (int iteration = 0; iteration < most_iterations && product > 0; ++iteration) {
    check_interruption();
    const VectorXd potential = equations.apply(step);
    const double energy = step.dot(potential);
    if (!(energy > 0)) {
      // Coincident panels make the matrix singular, and rounding and quadrature errors decide about the sign
      // of what is left. The charges are known if little was left to gain.
      column.decrement = product;
      return product <= almost_done * accuracy * column.charge.dot(net);
    }
    column.charge += product / energy * step;
    column.residual -= product / energy * potential;
    column.decrement = product / energy * product;
    if (column.decrement <= accuracy * column.charge.dot(net))
      break;
    const VectorXd next = preconditioner.apply(column.residual);
    const double next_product = column.residual.dot(next);
    step = next + next_product / product * step;
    product = next_product;
  }
  return true;
}

}  // namespace

TwoLevelPreconditioner::TwoLevelPreconditioner(const PanelEquations& equations, double tolerance)
    : equations_(equations), group_count_(index_of(equations.mesh.groups().size())),
      coarse_(index_of(equations.unknowns.coarse.size())), shares_(area_shares(equations.mesh)) {
  factor_ = factorised(matrix(), tolerance);
  is_positive_definite_ = factor_.is_positive_definite();
  for (const PanelGroup& group : equations.mesh.groups()) {
    check_interruption();
    groups_.push_back(factorised(matrix_of_group(group, equations.panels), tolerance));
    is_positive_definite_ &= groups_.back().is_positive_definite();
  }
}

/// Returns the row of a face's function: the groups come after the functions of the coarse space.
Index TwoLevelPreconditioner::place(std::size_t function) const {
  return index_of(function) < coarse_ ? index_of(function) : index_of(function) + group_count_;
}

/// Assembles the matrix of this space, only its lower triangle.
MatrixXd TwoLevelPreconditioner::matrix() const {
  const PanelUnknowns& unknowns = equations_.unknowns;
  const std::vector<PanelGroup>& groups = equations_.mesh.groups();
  MatrixXd matrix(unknowns.functions + group_count_, unknowns.functions + group_count_);
  std::vector<Index> functions = unknowns.coarse;
  functions.insert(functions.end(), unknowns.highest.begin(), unknowns.highest.end());
  for (std::size_t column = 0; column < functions.size(); ++column)
    for (std::size_t row = column; row < functions.size(); ++row)
      matrix(place(row), place(column)) = equations_.faces(functions[row], functions[column]);
  matrix.block(coarse_, coarse_, group_count_, group_count_).triangularView<Eigen::Lower>() =
      group_matrix(equations_.mesh, shares_, equations_.panels);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = index_of(groups[g].first), count = index_of(groups[g].count);
    const VectorXd with_faces = equations_.coupling.middleCols(first, count) * shares_.segment(first, count);
    const Index at = coarse_ + index_of(g);
    for (std::size_t k = 0; k < functions.size(); ++k)
      matrix(std::max(place(k), at), std::min(place(k), at)) = with_faces[functions[k]];
  }
  const auto leave_out = [&](Index row) {
    matrix.row(row).head(row).setZero();
    matrix.col(row).tail(matrix.rows() - row - 1).setZero();
  };
  for (std::size_t k = 0; k < functions.size(); ++k)
    if (!unknowns.is_present(functions[k]))
      leave_out(place(k));
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (!unknowns.is_present(unknowns.functions + index_of(groups[g].first)))
      leave_out(coarse_ + index_of(g));
  return matrix;
}

/// Restricts a vector of all unknowns to this space: one density on each group is the test function.
VectorXd TwoLevelPreconditioner::restricted(const VectorXd& full) const {
  const PanelUnknowns& unknowns = equations_.unknowns;
  VectorXd result(unknowns.functions + group_count_);
  for (Index k = 0; k < coarse_; ++k)
    result[k] = full[unknowns.coarse[static_cast<std::size_t>(k)]];
  result.segment(coarse_, group_count_) = group_means(equations_.mesh, shares_, full.tail(shares_.size()));
  for (std::size_t k = 0; k < unknowns.highest.size(); ++k)
    result[coarse_ + group_count_ + index_of(k)] = full[unknowns.highest[k]];
  return result;
}

/// Prolongates a vector of this space to all unknowns: the transpose of restricted().
VectorXd TwoLevelPreconditioner::prolonged(const VectorXd& coarse) const {
  const PanelUnknowns& unknowns = equations_.unknowns;
  VectorXd result(unknowns.functions + shares_.size());
  for (Index k = 0; k < coarse_; ++k)
    result[unknowns.coarse[static_cast<std::size_t>(k)]] = coarse[k];
  for (Index g = 0; g < group_count_; ++g) {
    const PanelGroup& group = equations_.mesh.groups()[static_cast<std::size_t>(g)];
    const auto first = index_of(group.first), count = index_of(group.count);
    result.segment(unknowns.functions + first, count) = coarse[coarse_ + g] * shares_.segment(first, count);
  }
  for (std::size_t k = 0; k < unknowns.highest.size(); ++k)
    result[unknowns.highest[k]] = coarse[coarse_ + group_count_ + index_of(k)];
  return result;
}

VectorXd TwoLevelPreconditioner::solve(const VectorXd& right_side, VectorXd& energy_roots) const {
  VectorXd charge = restricted(right_side);
  factor_.lower().solveInPlace(charge);
  energy_roots = charge.head(coarse_ + group_count_);
  factor_.upper().solveInPlace(charge);
  return prolonged(charge);
}

VectorXd TwoLevelPreconditioner::apply(const VectorXd& residual) const {
  VectorXd result = prolonged(factor_.solve(restricted(residual)));
  const std::vector<PanelGroup>& groups = equations_.mesh.groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Index first = equations_.unknowns.functions + index_of(groups[g].first);
    const auto count = index_of(groups[g].count);
    result.segment(first, count) += groups_[g].solve(residual.segment(first, count));
  }
  return result;
}

MatrixXd ConjugateGradientSolution::energies(const MatrixXd& net) const {
  const MatrixXd energies = net.transpose() * charges + charges.transpose() * residuals;
  return (energies + energies.transpose()) / 2;
}

MatrixXd ConjugateGradientSolution::iteration_error() const {
  return (decrements * decrements.transpose()).cwiseSqrt();
}

ConjugateGradientSolution solve_by_conjugate_gradients(const PanelEquations& equations,
                                                       const TwoLevelPreconditioner& preconditioner,
                                                       double accuracy) {
  const Eigen::MatrixXd& net = equations.unknowns.net;
  ConjugateGradientSolution result;
  result.charges.resize(net.rows(), net.cols());
  result.residuals.resize(net.rows(), net.cols());
  result.decrements.resize(net.cols());
  for (Index c = 0; c < net.cols(); ++c) {
    Column column;
    VectorXd energy_roots;
    column.charge = preconditioner.solve(net.col(c), energy_roots);
    column.residual = net.col(c) - equations.apply(column.charge);
    if (!conjugate_gradients(equations, preconditioner, net.col(c), accuracy, column)) {
      result.positive_definite = false;
      return result;
    }
    result.energy_roots.conservativeResize(energy_roots.size(), net.cols());
    result.energy_roots.col(c) = energy_roots;
    result.charges.col(c) = column.charge;
    result.residuals.col(c) = column.residual;
    result.decrements[c] = column.decrement;
  }
  return result;
}

}  // namespace fringe::detail
