#include "bem/bordered_matrix.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd BorderedMatrix::apply(const MatrixXd& factors) const {
  const Index count = functions.rows();
  MatrixXd result(factors.rows(), factors.cols());
  result.bottomRows(unknowns.size()) = unknowns.apply(factors.bottomRows(unknowns.size()));
  if (count > 0) {
    result.topRows(count) =
        functions * factors.topRows(count) + coupling * factors.bottomRows(unknowns.size());
    result.bottomRows(unknowns.size()) += coupling.transpose() * factors.topRows(count);
  }
  if (present.size() > 0)
    result.array().colwise() *= present.array();
  return result;
}

}  // namespace fringe::detail
