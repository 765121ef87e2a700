#include "bem/conjugate_gradients.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Limit of the number of steps. More are never needed: with the two-level preconditioner, every step reduces
/// the error by a factor of about three.
constexpr int most_iterations = 200;

struct Column {
  VectorXd charge;
  VectorXd residual;
  double gain = 0;
};

/// Runs conjugate gradients from the column's charge and residual. Returns false if the matrix is not
/// positive definite.
bool descend(const PanelEquations& equations, const NestedSpace& nested, const VectorXd& net, double accuracy,
             Column& column) {
  VectorXd step = nested.preconditioned(column.residual);
  double product = column.residual.dot(step);
  for (int iteration = 0; iteration < most_iterations && product > 0; ++iteration) {
    const VectorXd potential = equations.apply(step);
    const double energy = step.dot(potential);
    if (!(energy > 0))
      return false;
    column.charge += product / energy * step;
    column.residual -= product / energy * potential;
    column.gain = product / energy * product;
    if (column.gain <= accuracy * column.charge.dot(net))
      break;
    const VectorXd next = nested.preconditioned(column.residual);
    const double next_product = column.residual.dot(next);
    step = next + next_product / product * step;
    product = next_product;
  }
  return true;
}

}  // namespace

IteratedCharges iterate(const PanelEquations& equations, const NestedSpace& nested, double accuracy) {
  const Eigen::MatrixXd& net = equations.unknowns.net;
  IteratedCharges result;
  result.charges.resize(net.rows(), net.cols());
  result.residuals.resize(net.rows(), net.cols());
  result.gains.resize(net.cols());
  for (Index c = 0; c < net.cols(); ++c) {
    Column column;
    VectorXd smaller;
    column.charge = nested.solve(net.col(c), smaller);
    column.residual = net.col(c) - equations.apply(column.charge);
    if (!descend(equations, nested, net.col(c), accuracy, column)) {
      result.positive_definite = false;
      return result;
    }
    result.smaller.conservativeResize(smaller.size(), net.cols());
    result.smaller.col(c) = smaller;
    result.charges.col(c) = column.charge;
    result.residuals.col(c) = column.residual;
    result.gains[c] = column.gain;
  }
  return result;
}

}  // namespace fringe::detail
