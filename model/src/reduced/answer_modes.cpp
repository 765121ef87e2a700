#include "reduced/answer_modes.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd root_of_answers(const MachineLink& machine) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> of_answers(charges_by_potentials(
      machine.functions().energies(), machine.net().cast<double>(), machine.to_ground()));
  return of_answers.eigenvectors() * of_answers.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

AnswerModes answer_modes(const MachineLink& machine, const MatrixXd& root,
                         const OutsidePotentials& potentials, std::span<const Eigen::Vector3d> places,
                         Index most, std::size_t threads) {
  const MatrixXd seen = potentials.at(places, true, nullptr, threads).of_functions.cast<double>() * root;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(seen.transpose() * seen);
  const Index modes = std::min(most, root.rows());
  AnswerModes result;
  result.charges = (root * solver.eigenvectors().rightCols(modes).rowwise().reverse()).cast<float>();
  const Eigen::MatrixXf own = (machine.functions().energies() * result.charges.cast<double>()).cast<float>();
  result.missing = machine.coarse().defects(result.charges, own).cast<float>();
  return result;
}

}  // namespace fringe::detail
