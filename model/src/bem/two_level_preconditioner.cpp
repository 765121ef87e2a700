#include "bem/two_level_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "numeric/interruption.hpp"
#include "numeric/parallel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

/// Factorises the matrix that `make` returns, of which the lower triangle is read. Functions that depend on
/// earlier ones are left out if the tolerance of the quadratures is so fine that these are not the reason.
template <class Make>
Cholesky factorised(const Make& make, double tolerance, std::size_t threads) {
  /// Tolerance of the quadratures above which a matrix that is not positive definite calls for better ones.
  constexpr double sufficient = 1e-5;
  /// Least energy that a function adds to earlier ones, relative to its own: of a panel between others it is
  /// about the ratio of the gap to the panel.
  constexpr double least_energy = 1e-6;
  MatrixXd matrix = make();
  const VectorXd energies = matrix.diagonal();
  Cholesky factor(std::move(matrix), threads);
  const bool is_regular =
      factor.is_positive_definite() &&
      (factor.factor().diagonal().array().square() > least_energy * energies.array()).all();
  if (!is_regular && tolerance <= sufficient) {
    // The matrix is rarely needed again, and copying it beforehand would take as long as making it anew.
    matrix = make();
    leave_out_dependent(matrix, std::max(least_energy, 10 * tolerance));
    factor = Cholesky(std::move(matrix), threads);
  }
  return factor;
}

/// Replaces the rows and columns of functions that are left out by those of the unit matrix.
void leave_out(MatrixXd& matrix, const VectorXd& present) {
  for (Index k = 0; k < present.size(); ++k)
    if (present[k] == 0) {
      matrix.row(k).setZero();
      matrix.col(k).setZero();
      matrix(k, k) = 1;
    }
}

/// Returns the matrix of the functions, and of the coarse functions after them.
MatrixXd coarse_matrix(const BorderedMatrix& matrix, const CoarseSpace& coarse) {
  const Index functions = matrix.functions.rows(), coarse_size = coarse.matrix.rows();
  MatrixXd coupling = MatrixXd::Zero(functions, coarse_size);
  for (Index k = 0; k < matrix.coupling.cols(); ++k)
    coupling.col(coarse.restriction.target[static_cast<std::size_t>(k)]) +=
        coarse.restriction.weights[k] * matrix.coupling.col(k).cast<double>();
  MatrixXd whole(functions + coarse_size, functions + coarse_size);
  whole << matrix.functions, coupling, coupling.transpose(), coarse.matrix;
  if (matrix.present.size() > 0) {
    VectorXd kept = VectorXd::Zero(functions + coarse_size);
    kept.head(functions) = matrix.present.head(functions);
    for (Index k = 0; k < matrix.unknowns.size(); ++k)
      if (matrix.present[functions + k] != 0)
        kept[functions + coarse.restriction.target[static_cast<std::size_t>(k)]] = 1;
    leave_out(whole, kept);
  }
  return whole;
}

/// Returns the matrix of a leaf's unknowns.
MatrixXd leaf_matrix(const BorderedMatrix& matrix, std::size_t leaf) {
  MatrixXd block = matrix.unknowns.diagonal_block(leaf);
  const ClusterRange range = matrix.unknowns.range(matrix.unknowns.leaves()[leaf]);
  if (matrix.present.size() > 0)
    leave_out(block, matrix.present.segment(matrix.functions.rows() + range.first, range.count));
  return block;
}

}  // namespace

TwoLevelPreconditioner::TwoLevelPreconditioner(const BorderedMatrix& matrix, const CoarseSpace& coarse,
                                               double tolerance, std::size_t threads)
    : matrix_(matrix), restriction_(coarse.restriction), leaves_(matrix.unknowns.leaves().size()),
      threads_(threads) {
  coarse_ = factorised([&] { return coarse_matrix(matrix, coarse); }, tolerance, threads);
  parallel_for(leaves_.size(), threads, [&](std::size_t leaf) {
    leaves_[leaf] = factorised([&] { return leaf_matrix(matrix, leaf); }, tolerance, 1);
  });
  is_positive_definite_ = coarse_.is_positive_definite() &&
                          std::all_of(leaves_.begin(), leaves_.end(),
                                      [](const Cholesky& leaf) { return leaf.is_positive_definite(); });
}

MatrixXd TwoLevelPreconditioner::apply(const MatrixXd& residuals) const {
  const Index functions = matrix_.functions.rows();
  MatrixXd result(residuals.rows(), residuals.cols());
  parallel_for(leaves_.size(), threads_, [&](std::size_t leaf) {
    const ClusterRange range = matrix_.unknowns.range(matrix_.unknowns.leaves()[leaf]);
    result.middleRows(functions + range.first, range.count) =
        leaves_[leaf].solve(residuals.middleRows(functions + range.first, range.count));
  });
  MatrixXd coarse = MatrixXd::Zero(coarse_.factor().rows(), residuals.cols());
  coarse.topRows(functions) = residuals.topRows(functions);
  for (Index k = 0; k < matrix_.unknowns.size(); ++k)
    coarse.row(functions + restriction_.target[static_cast<std::size_t>(k)]) +=
        restriction_.weights[k] * residuals.row(functions + k);
  coarse = coarse_.solve(coarse);
  result.topRows(functions) = coarse.topRows(functions);
  for (Index k = 0; k < matrix_.unknowns.size(); ++k)
    result.row(functions + k) +=
        restriction_.weights[k] * coarse.row(functions + restriction_.target[static_cast<std::size_t>(k)]);
  if (matrix_.present.size() > 0)
    result.array().colwise() *= matrix_.present.array();
  return result;
}

CoarseSpace coarse_space(const HierarchicalMatrix& matrix, const VectorXd& areas,
                         const std::vector<std::size_t>& bodies, Index together) {
  CoarseSpace space{{std::vector<Index>(bodies.size()), areas}, {}};
  VectorXd totals = VectorXd::Zero(areas.size());
  Index size = 0;
  for (const std::size_t cluster : matrix.leaves()) {
    const ClusterRange leaf = matrix.range(cluster);
    for (Index first = leaf.first; first < leaf.first + leaf.count; first += together) {
      std::map<std::size_t, Index> functions;
      for (Index k = first; k < std::min(first + together, leaf.first + leaf.count); ++k) {
        const auto [function, is_new] = functions.try_emplace(bodies[static_cast<std::size_t>(k)], size);
        size += is_new ? 1 : 0;
        space.restriction.target[static_cast<std::size_t>(k)] = function->second;
        totals[function->second] += areas[k];
      }
    }
  }
  for (Index k = 0; k < areas.size(); ++k)
    space.restriction.weights[k] /= totals[space.restriction.target[static_cast<std::size_t>(k)]];
  space.matrix = matrix.dense_restricted(space.restriction, size);
  return space;
}

}  // namespace fringe::detail
