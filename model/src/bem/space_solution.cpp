#include "bem/space_solution.hpp"

#include <utility>
#include <vector>

#include "numeric/cholesky.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd of_pairs(const VectorXd& energies) {
  return (energies * energies.transpose()).cwiseSqrt();
}

/// Returns the energies of all pairs of columns, whose errors are of second order in the residuals.
MatrixXd energies(const MatrixXd& right_sides, const MatrixXd& charges, const MatrixXd& residuals) {
  const MatrixXd result = right_sides.transpose() * charges + charges.transpose() * residuals;
  return (result + result.transpose()) / 2;
}

}  // namespace

MatrixXd SpaceSolution::iteration_error() const {
  return of_pairs(missing);
}

MatrixXd SpaceSolution::iteration_error_of_change() const {
  return of_pairs(missing_of_change);
}

SpaceSolution solve_space(const BorderedMatrix& matrix, const TwoLevelPreconditioner& preconditioner,
                          const MatrixXd& net, const VectorXd& accuracy, MatrixXd start) {
  ConjugateGradientSolution found = conjugate_gradients(matrix, preconditioner, net, accuracy,
                                                        VectorXd::Zero(net.cols()), std::move(start));
  SpaceSolution result;
  result.positive_definite = found.positive_definite;
  if (!result.positive_definite)
    return result;
  result.matrix = energies(net, found.charges, found.residuals);
  result.charges = std::move(found.charges);
  result.residuals = std::move(found.residuals);
  result.missing = std::move(found.decrements);
  return result;
}

SpaceSolution solve_functions(const BorderedMatrix& matrix, const MatrixXd& net) {
  const Index functions = matrix.functions.rows();
  MatrixXd present = matrix.functions;
  for (Index k = 0; k < functions; ++k)
    if (matrix.present.size() > 0 && matrix.present[k] == 0) {
      present.row(k).setZero();
      present.col(k).setZero();
      present(k, k) = 1;
    }
  const Cholesky factor(std::move(present));
  SpaceSolution result;
  result.positive_definite = factor.is_positive_definite();
  if (!result.positive_definite)
    return result;
  result.charges = MatrixXd::Zero(net.rows(), net.cols());
  result.charges.topRows(functions) = factor.solve(MatrixXd(net.topRows(functions)));
  result.residuals = MatrixXd::Zero(net.rows(), net.cols());
  result.matrix = energies(net, result.charges, result.residuals);
  result.missing = VectorXd::Zero(net.cols());
  return result;
}

SpaceSolution solve_with_targets(const BorderedMatrix& matrix, const TwoLevelPreconditioner& preconditioner,
                                 const MatrixXd& net, const VectorXd& accuracy, MatrixXd start,
                                 const SpaceSolution& background, const VectorXd& is_machine) {
  const Index columns = net.cols();
  // The background's charges leave the residuals of their iteration on the machine, and on the targets minus
  // the potential that they induce there.
  MatrixXd given = net - matrix.apply(background.charges);
  MatrixXd left = is_machine.asDiagonal() * given;
  std::vector<Index> changed;
  VectorXd least(columns);
  for (Index c = 0; c < columns; ++c) {
    least[c] = change_scale(background.matrix(c, c), 0);
    if (background.matrix(c, c) > 0 || (is_machine.array() * net.col(c).array() == 0).all())
      changed.push_back(c);
    else
      left.col(c).setZero();
  }
  given -= left;
  ConjugateGradientSolution found =
      conjugate_gradients(matrix, preconditioner, given, accuracy, least, std::move(start));
  SpaceSolution result;
  result.positive_definite = found.positive_definite;
  if (!result.positive_definite)
    return result;
  // The background's residuals make an error of first order in the change, which this adds.
  const MatrixXd added = left.transpose() * found.charges;
  const MatrixXd change = energies(given, found.charges, found.residuals) + added + added.transpose();
  result.charges = background.charges + found.charges;
  result.residuals = left + found.residuals;
  result.matrix = energies(net, result.charges, result.residuals);
  for (const Index c : changed)
    for (const Index d : changed)
      result.matrix(c, d) = background.matrix(c, d) + change(c, d);
  result.missing = background.missing + found.decrements;
  result.missing_of_change = std::move(found.decrements);
  // The targets answer to charges that the background misses, too, by at most the energy of these.
  for (const Index c : changed)
    result.missing_of_change[c] += background.missing[c];
  return result;
}

}  // namespace fringe::detail
