#include "bem/maxwell_matrix.hpp"

#include <Eigen/Cholesky>

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd without_floating(const MatrixXd& matrix, std::size_t floating) {
  const auto insulated = static_cast<Index>(floating);
  const Index kept = matrix.rows() - insulated;
  if (insulated == 0)
    return matrix;
  return matrix.topLeftCorner(kept, kept) -
         matrix.topRightCorner(kept, insulated) * matrix.bottomRightCorner(insulated, insulated)
                                                      .llt()
                                                      .solve(matrix.bottomLeftCorner(insulated, kept));
}

MatrixXd changes(const MatrixXd& fine, const MatrixXd& coarse) {
  const MatrixXd change = fine - coarse;
  const Eigen::VectorXd relative = (change.diagonal().array() / fine.diagonal().array()).cwiseMax(0).sqrt();
  return change.cwiseAbs().cwiseMax((relative * relative.transpose()).cwiseProduct(fine.cwiseAbs()));
}

}  // namespace fringe::detail
