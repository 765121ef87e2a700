#include "bem/space_solution.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "numeric/interruption.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Limit of the number of steps; what they leave is stated.
constexpr int most_iterations = 200;

/// Multiple of the accuracy below which a remaining decrement is small.
constexpr double almost_done = 30;

MatrixXd of_pairs(const VectorXd& energies) {
  return (energies * energies.transpose()).cwiseSqrt();
}

/// Returns the energies of all pairs of columns, whose errors are of second order in the residuals.
MatrixXd energies(const MatrixXd& right_sides, const MatrixXd& charges, const MatrixXd& residuals) {
  const MatrixXd result = right_sides.transpose() * charges + charges.transpose() * residuals;
  return (result + result.transpose()) / 2;
}

/// Solves matrix·charges = right_sides from charges of any accuracy, and stops each column when a step
/// changes its energy by less than its part of `accuracy` of that energy, or of `least` where that is larger.
/// Writes no matrix; the missing energies are those by which the last steps changed the columns'.
SpaceSolution conjugate_gradients(const BorderedMatrix& matrix, const TwoLevelPreconditioner& preconditioner,
                                  const MatrixXd& right_sides, const VectorXd& accuracy,
                                  const VectorXd& least, MatrixXd start) {
  SpaceSolution result;
  result.charges = std::move(start);
  result.residuals = right_sides - matrix.apply(result.charges);
  result.missing = VectorXd::Zero(right_sides.cols());

  std::vector<Index> active;
  for (Index c = 0; c < right_sides.cols(); ++c)
    if (!right_sides.col(c).isZero(0))
      active.push_back(c);
  MatrixXd steps = preconditioner.apply(result.residuals(Eigen::all, active));
  VectorXd products = result.residuals(Eigen::all, active).cwiseProduct(steps).colwise().sum().transpose();
  for (; !active.empty() && result.iterations < most_iterations; ++result.iterations) {
    check_interruption();
    const MatrixXd potentials = matrix.apply(steps);
    std::vector<Index> left, kept;
    for (std::size_t k = 0; k < active.size(); ++k) {
      const Index c = active[k], at = static_cast<Index>(k);
      const double energy = steps.col(at).dot(potentials.col(at)), product = products[at];
      if (!(product > 0))
        continue;
      const double own = std::max(result.charges.col(c).dot(right_sides.col(c)), least[c]);
      if (!(energy > 0)) {
        // Coincident panels make the matrix singular, and rounding and quadrature errors decide about the
        // sign of what is left. The charges are known if little was left to gain.
        result.missing[c] = product;
        result.positive_definite &= product <= almost_done * accuracy[c] * own;
        continue;
      }
      const double length = product / energy;
      result.charges.col(c) += length * steps.col(at);
      result.residuals.col(c) -= length * potentials.col(at);
      result.missing[c] = length * product;
      const double reached = std::max(result.charges.col(c).dot(right_sides.col(c)), least[c]);
      if (result.missing[c] > accuracy[c] * reached) {
        left.push_back(c);
        kept.push_back(at);
      }
    }
    if (!result.positive_definite)
      return result;
    active = std::move(left);
    if (active.empty())
      break;
    const MatrixXd next = preconditioner.apply(result.residuals(Eigen::all, active));
    const VectorXd next_products =
        result.residuals(Eigen::all, active).cwiseProduct(next).colwise().sum().transpose();
    const VectorXd factors = next_products.cwiseQuotient(products(kept));
    // The new steps may have fewer columns, and the old ones must live until they are computed.
    steps = (next + steps(Eigen::all, kept) * factors.asDiagonal()).eval();
    products = next_products;
  }
  return result;
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
  SpaceSolution result = conjugate_gradients(matrix, preconditioner, net, accuracy,
                                             VectorXd::Zero(net.cols()), std::move(start));
  if (result.positive_definite)
    result.matrix = energies(net, result.charges, result.residuals);
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
  SpaceSolution result =
      conjugate_gradients(matrix, preconditioner, given, accuracy, least, std::move(start));
  if (!result.positive_definite)
    return result;
  // The background's residuals make an error of first order in the change, which this adds.
  const MatrixXd added = left.transpose() * result.charges;
  const MatrixXd change = energies(given, result.charges, result.residuals) + added + added.transpose();
  result.charges += background.charges;
  result.residuals += left;
  result.matrix = energies(net, result.charges, result.residuals);
  for (const Index c : changed)
    for (const Index d : changed)
      result.matrix(c, d) = background.matrix(c, d) + change(c, d);
  result.missing_of_change = result.missing;
  result.missing += background.missing;
  // The targets answer to charges that the background misses, too, by at most the energy of these.
  for (const Index c : changed)
    result.missing_of_change[c] += background.missing[c];
  return result;
}

}  // namespace fringe::detail
