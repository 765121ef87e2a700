#include "readings/maxwell_matrix.hpp"

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd floating_block(const MatrixXd& matrix, const ChargedBodies& bodies) {
  const auto floating = static_cast<Index>(count_of(bodies, Role::floating));
  const Index kept = matrix.rows() - floating;
  MatrixXd block = matrix.bottomRightCorner(floating, floating);
  for (Index k = 0; k < floating; ++k) {
    if (block(k, k) == 0)
      block(k, k) = 1;
    block(k, k) += bodies.conductors[static_cast<std::size_t>(kept + k)].to_ground;
  }
  return block;
}

MatrixXd potentials(const MatrixXd& matrix, const ChargedBodies& bodies) {
  const auto floating = static_cast<Index>(count_of(bodies, Role::floating));
  const Index kept = matrix.rows() - floating;
  MatrixXd result = MatrixXd::Identity(matrix.rows(), kept);
  if (floating > 0)
    result.bottomRows(floating) =
        -floating_block(matrix, bodies).llt().solve(matrix.bottomLeftCorner(floating, kept));
  return result;
}

MatrixXd without_floating(const MatrixXd& matrix, const ChargedBodies& bodies) {
  const MatrixXd at = potentials(matrix, bodies);
  return at.cols() == matrix.cols() ? matrix : matrix.topRows(at.cols()) * at;
}

MatrixXd member_charges(const MatrixXd& matrix, const MatrixXd& body_charges, const ChargedBodies& bodies) {
  const MatrixXd charges = body_charges * potentials(matrix, bodies);
  std::vector<Index> first;
  Index members = 0;
  for (const ChargedConductor& conductor : bodies.conductors) {
    first.push_back(members);
    if (conductor.role != Role::floating)
      members += static_cast<Index>(conductor.members.size());
  }
  MatrixXd result = MatrixXd::Zero(members, charges.cols());
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k)
    if (const ChargedBody& body = bodies.bodies[k]; bodies.role(body) != Role::floating)
      result.row(first[body.conductor] + static_cast<Index>(body.member)) +=
          charges.row(static_cast<Index>(k));
  return result;
}

MaxwellMatrix named_answer(const ChargedBodies& bodies) {
  MaxwellMatrix answer;
  answer.sensors = count_of(bodies, Role::sensor);
  for (const ChargedConductor& conductor : bodies.conductors) {
    if (conductor.role == Role::floating) {
      answer.floating.push_back(conductor.name);
      continue;
    }
    answer.conductors.push_back(conductor.name);
    answer.members.push_back(conductor.members);
  }
  answer.lower_bounds.assign(answer.conductors.size(), false);
  return answer;
}

Eigen::VectorXd asked_energies(const MatrixXd& matrix, const ChargedBodies& bodies) {
  Eigen::VectorXd energies = matrix.diagonal();
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k)
    if (!bodies.conductors[k].is_asked)
      energies[static_cast<Index>(k)] = std::numeric_limits<double>::infinity();
  return energies;
}

MatrixXd changes(const MatrixXd& fine, const MatrixXd& coarse) {
  const MatrixXd change = fine - coarse;
  const Eigen::VectorXd relative = (change.diagonal().array() / fine.diagonal().array()).cwiseMax(0).sqrt();
  return change.cwiseAbs().cwiseMax((relative * relative.transpose()).cwiseProduct(fine.cwiseAbs()));
}

}  // namespace fringe::detail
