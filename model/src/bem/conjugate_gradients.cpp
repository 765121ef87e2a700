#include "bem/conjugate_gradients.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Limit of the number of steps; what they leave is stated.
constexpr int most_iterations = 200;

/// Multiple of the accuracy below which a remaining decrement is small.
constexpr double almost_done = 30;

}  // namespace

ConjugateGradientSolution conjugate_gradients(const BorderedMatrix& matrix,
                                              const TwoLevelPreconditioner& preconditioner,
                                              const MatrixXd& right_sides, const VectorXd& accuracy,
                                              const VectorXd& least, MatrixXd start) {
  ConjugateGradientSolution result;
  result.charges = std::move(start);
  result.residuals = right_sides - matrix.apply(result.charges);
  result.decrements = VectorXd::Zero(right_sides.cols());

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
        result.decrements[c] = product;
        result.positive_definite &= product <= almost_done * accuracy[c] * own;
        continue;
      }
      const double length = product / energy;
      result.charges.col(c) += length * steps.col(at);
      result.residuals.col(c) -= length * potentials.col(at);
      result.decrements[c] = length * product;
      const double reached = std::max(result.charges.col(c).dot(right_sides.col(c)), least[c]);
      if (result.decrements[c] > accuracy[c] * reached) {
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

}  // namespace fringe::detail
