#include "reduced/coarse_charges.hpp"

#include <utility>

#include "numeric/cholesky.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Finds the rows of a matrix, which belong to functions, weighted and added up to the sums of functions.
template <typename Matrix>
void sum(const CoarseFunctions& functions, const Matrix& rows, Matrix& sums) {
  sums.setZero(functions.count, rows.cols());
  // Without conductors that float there are no columns, and of an empty matrix no row can be taken.
  for (Index column = 0; column < rows.cols(); ++column)
    for (Index k = 0; k < rows.rows(); ++k)
      sums(functions.of[static_cast<std::size_t>(k)], column) +=
          static_cast<typename Matrix::Scalar>(functions.shares[k]) * rows(k, column);
}

template <typename Matrix>
Matrix summed(const CoarseFunctions& functions, const Matrix& rows) {
  Matrix sums;
  sum(functions, rows, sums);
  return sums;
}

}  // namespace

MatrixXd charges_by_potentials(const MatrixXd& energies) {
  /// Part of the diagonal that is added, growing until the matrix is positive definite.
  double ridge = 1e-9;
  while (true) {
    MatrixXd matrix = energies;
    matrix.diagonal() *= 1 + ridge;
    const Cholesky factor(std::move(matrix));
    if (factor.is_positive_definite())
      return factor.solve(MatrixXd::Identity(energies.rows(), energies.cols()));
    ridge *= 10;
  }
}

void FloatingCharges::take(const Eigen::Ref<const MatrixXd>& net, const Eigen::Ref<const MatrixXd>& responses,
                           const VectorXd& to_ground, Eigen::Ref<MatrixXd> charges) {
  if (net.cols() == 0)
    return;
  block_.noalias() = net.transpose() * responses;
  block_.diagonal() += to_ground;
  factor_.compute(block_);
  taken_.noalias() = net.transpose() * charges;
  factor_.solveInPlace(taken_);
  charges.noalias() -= responses * taken_;
}

MatrixXd charges_by_potentials(const MatrixXd& energies, const MatrixXd& net, const VectorXd& to_ground) {
  MatrixXd answers = charges_by_potentials(energies);
  FloatingCharges().take(net, answers * net, to_ground, answers);
  return answers;
}

VectorXd to_ground_of(const ChargedBodies& bodies) {
  const std::size_t count = count_of(bodies, Role::floating);
  VectorXd result(index_of(count));
  for (std::size_t k = 0; k < count; ++k)
    result[index_of(k)] = bodies.conductors[bodies.conductors.size() - count + k].to_ground;
  return result;
}

MatrixXd net_on_floating(const ChargeFunctions& functions, const ChargedBodies& bodies) {
  return functions.net(bodies.conductors.size()).rightCols(index_of(count_of(bodies, Role::floating)));
}

CoarseCharges::CoarseCharges(const ChargeFunctions& functions, const MatrixXd& net, const VectorXd& to_ground)
    : functions_(functions.coarse()) {
  MatrixXd energies = MatrixXd::Zero(functions_.count, functions_.count);
  const auto count = index_of(functions_.of.size());
  for (Index a = 0; a < count; ++a)
    for (Index b = 0; b < count; ++b)
      energies(functions_.of[static_cast<std::size_t>(a)], functions_.of[static_cast<std::size_t>(b)]) +=
          functions_.shares[a] * functions_.shares[b] * functions.energies()(a, b);
  inverse_ = charges_by_potentials(energies, summed(functions_, net), to_ground).cast<float>();
}

MatrixXd CoarseCharges::defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials) const {
  Workspace workspace;
  find_defects(charges, potentials, workspace);
  return std::move(workspace.defects);
}

void CoarseCharges::find_defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials,
                                 Workspace& workspace) const {
  sum(functions_, potentials, workspace.sums);
  workspace.answers.noalias() = inverse_ * workspace.sums;
  workspace.energies.noalias() = charges.transpose() * potentials;
  workspace.of_sums.noalias() = workspace.sums.transpose() * workspace.answers;
  workspace.defects = (workspace.energies - workspace.of_sums).cast<double>();
}

}  // namespace fringe::detail
