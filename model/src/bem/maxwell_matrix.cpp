#include "bem/maxwell_matrix.hpp"

#include <string>
#include <utility>

#include <Eigen/Cholesky>

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd without_floating(const MatrixXd& matrix, const ChargedBodies& bodies) {
  const auto insulated = static_cast<Index>(count_of(bodies, Role::floating));
  const Index kept = matrix.rows() - insulated;
  if (insulated == 0)
    return matrix;
  return matrix.topLeftCorner(kept, kept) -
         matrix.topRightCorner(kept, insulated) * matrix.bottomRightCorner(insulated, insulated)
                                                      .llt()
                                                      .solve(matrix.bottomLeftCorner(insulated, kept));
}

MaxwellMatrix named_answer(const ChargedBodies& bodies) {
  MaxwellMatrix answer;
  answer.conductors = names_of(bodies, Role::electrode);
  answer.sensors = answer.conductors.size();
  for (std::string& name : names_of(bodies, Role::grounded))
    answer.conductors.push_back(std::move(name));
  answer.floating = names_of(bodies, Role::floating);
  answer.lower_bounds.assign(answer.conductors.size(), false);
  return answer;
}

MatrixXd changes(const MatrixXd& fine, const MatrixXd& coarse) {
  const MatrixXd change = fine - coarse;
  const Eigen::VectorXd relative = (change.diagonal().array() / fine.diagonal().array()).cwiseMax(0).sqrt();
  return change.cwiseAbs().cwiseMax((relative * relative.transpose()).cwiseProduct(fine.cwiseAbs()));
}

}  // namespace fringe::detail
