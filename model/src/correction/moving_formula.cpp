#include "correction/moving_formula.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Cholesky>

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;
using Eigen::VectorXf;

/// Ratio of the stated error to the sum of its parts: measured (model/CORRECTIONS.md, section 8).
constexpr double safety_of_links = 4;

/// Part of the diagonal that is added, growing until the matrix is positive definite: rounding of single
/// precision.
constexpr float least_ridge = 1e-6F;

/// Factorises a symmetric matrix in place, with so much on its diagonal that it is positive definite.
void factorise_in_place(MatrixXf& matrix) {
  float ridge = least_ridge;
  while (true) {
    MatrixXf factor = matrix;
    factor.diagonal() *= 1 + ridge;
    const Eigen::LLT<Eigen::Ref<MatrixXf>> factorised(factor);
    if (factorised.info() == Eigen::Success) {
      matrix = std::move(factor);
      return;
    }
    if (!(ridge < 1))
      throw std::runtime_error("the matrix of the links' charges is not positive definite");
    ridge *= 10;
  }
}

}  // namespace

double MovingFormula::nearness(const MovingMachine& machine, const TargetAtRest& target,
                               const std::vector<Isometry3d>& links, const Isometry3d& frame) {
  double nearness = 0;
  for (std::size_t link = 0; link < links.size(); ++link) {
    const Isometry3d pose = links[link].inverse(Eigen::Isometry) * frame;
    for (std::size_t function = 0; function < target.functions().count(); ++function)
      for (const PlacedBox& box : machine.used(link))
        nearness = std::max(nearness, target.functions().radius(function) /
                                          box.distance(pose * target.functions().centre(function)));
  }
  return nearness;
}

/// Evaluates the couplings of what has moved against each other.
void MovingFormula::couple(const MovingMachine& machine, const LinkTables& tables, const TargetAtRest& target,
                           const std::vector<Isometry3d>& links, const Isometry3d& frame) {
  const std::size_t count = links.size();
  const bool is_first = between_links_.empty() && with_target_.empty();
  between_links_.resize(count * (count - 1) / 2);
  with_target_.resize(count);
  std::size_t pair = 0;
  for (std::size_t a = 0; a < count; ++a) {
    const ChargeFunctions& functions = machine.links()[a].functions();
    for (std::size_t b = a + 1; b < count; ++b, ++pair) {
      LinkCoupling& coupling = between_links_[pair];
      const Isometry3d relative = links[b].inverse(Eigen::Isometry) * links[a];
      if (!is_first && keep_relative_pose(coupling.relative, relative))
        continue;
      const ChargeFunctions& others = machine.links()[b].functions();
      coupling.relative = relative;
      coupler_.couple(functions, others, relative, coupling.functions);
      tables.of(a).write(others, relative.inverse(Eigen::Isometry), coupling.given_first);
      tables.of(b).write(functions, relative, coupling.given_second);
    }
    LinkCoupling& coupling = with_target_[a];
    const Isometry3d relative = links[a].inverse(Eigen::Isometry) * frame;
    if (!is_first && keep_relative_pose(coupling.relative, relative))
      continue;
    coupling.relative = relative;
    coupler_.couple(target.functions(), functions, relative, coupling.functions);
    tables.of(a).write(target.functions(), relative, coupling.given_second);
  }
}

/// Puts the couplings together.
void MovingFormula::assemble(const MovingMachine& machine, const TargetAtRest& target) {
  const std::size_t count = machine.links().size();
  const Index loads = machine.loads();
  if (first_.empty()) {
    first_.push_back(0);
    for (const MachineLink& link : machine.links())
      first_.push_back(first_.back() + index_of(link.functions().count()));
  }
  matrix_.resize(first_.back(), first_.back());
  coupling_.resize(first_.back(), index_of(target.functions().count()));
  on_machine_.setZero(first_.back(), 2 * loads);
  on_target_.setZero(index_of(target.functions().count()), 2 * loads);
  // Adds potentials of the charges that are given on a link.
  const auto add = [&](const MachineLink& link, const MatrixXf& potentials, auto&& to) {
    const Index own = index_of(link.loads().size());
    for (Index k = 0; k < own; ++k) {
      const Index load = link.loads()[static_cast<std::size_t>(k)];
      to.col(load) += potentials.col(k);
      to.col(loads + load) += potentials.col(own + k);
    }
  };
  std::size_t pair = 0;
  for (std::size_t a = 0; a < count; ++a) {
    const MachineLink& link = machine.links()[a];
    const Index first = first_[a], size = first_[a + 1] - first;
    matrix_.block(first, first, size, size) = link.energies();
    coupling_.middleRows(first, size) = with_target_[a].functions;
    add(link, with_target_[a].given_second, on_target_);
    for (std::size_t b = a + 1; b < count; ++b, ++pair) {
      const LinkCoupling& coupling = between_links_[pair];
      const Index other = first_[b], other_size = first_[b + 1] - other;
      matrix_.block(other, first, other_size, size) = coupling.functions;
      matrix_.block(first, other, size, other_size) = coupling.functions.transpose();
      add(link, coupling.given_first, on_machine_.middleRows(other, other_size));
      add(machine.links()[b], coupling.given_second, on_machine_.middleRows(first, size));
    }
  }
}

/// Factorises the machine's matrix, and that of the conductors that float.
void MovingFormula::factorise(const MovingMachine& machine) {
  answers_.scales = matrix_.diagonal().cwiseSqrt().cwiseInverse();
  answers_.factor = answers_.scales.asDiagonal() * matrix_ * answers_.scales.asDiagonal();
  factorise_in_place(answers_.factor);
  Index floating = 0;
  for (const MachineLink& link : machine.links())
    floating += link.net().cols();
  answers_.floating.setZero(first_.back(), floating);
  VectorXf to_ground(floating);
  Index column = 0;
  for (std::size_t k = 0; k < machine.links().size(); ++k) {
    const MatrixXf& net = machine.links()[k].net();
    if (net.cols() == 0)
      continue;
    answers_.floating.block(first_[k], column, net.rows(), net.cols()) = net;
    to_ground.segment(column, net.cols()) = machine.links()[k].to_ground().cast<float>();
    column += net.cols();
  }
  if (floating == 0)
    return;
  answers_.floating = answers_.scales.asDiagonal() * answers_.floating;
  answers_.factor.triangularView<Eigen::Lower>().solveInPlace(answers_.floating);
  answers_.floating_block = answers_.floating.transpose() * answers_.floating;
  answers_.floating_block.diagonal() += to_ground;
  factorise_in_place(answers_.floating_block);
}

/// Finds the part of solved potentials that conductors which float take: what it adds to their own
/// potentials.
void MovingFormula::project(const MatrixXf& solved, MatrixXf& on_floating) const {
  on_floating.resize(answers_.floating.cols(), solved.cols());
  if (on_floating.rows() == 0)
    return;
  on_floating = answers_.floating.transpose() * solved;
  answers_.floating_block.triangularView<Eigen::Lower>().solveInPlace(on_floating);
}

/// Returns the charges of the machine's functions by potentials that the factor has solved.
MatrixXf MovingFormula::charges(MatrixXf solved, const MatrixXf& on_floating) const {
  if (on_floating.rows() > 0) {
    const MatrixXf own =
        answers_.floating_block.transpose().triangularView<Eigen::Upper>().solve(on_floating);
    solved -= answers_.floating * own;
  }
  answers_.factor.transpose().triangularView<Eigen::Upper>().solveInPlace(solved);
  return answers_.scales.asDiagonal() * solved;
}

const std::vector<CompanyFormula::Change>&
MovingFormula::solved(const MovingMachine& machine, const LinkTables& tables, const TargetAtRest& target,
                      const std::vector<Isometry3d>& links, const Isometry3d& frame) {
  couple(machine, tables, target, links, frame);
  assemble(machine, target);
  factorise(machine);
  const Index loads = machine.loads(), functions = index_of(target.functions().count()),
              floating = index_of(target.floating().size());
  // The machine answers the target's functions and the given charges.
  MatrixXf by_target = answers_.scales.asDiagonal() * coupling_,
           by_given = answers_.scales.asDiagonal() * on_machine_, target_floating, given_floating;
  answers_.factor.triangularView<Eigen::Lower>().solveInPlace(by_target);
  answers_.factor.triangularView<Eigen::Lower>().solveInPlace(by_given);
  project(by_target, target_floating);
  project(by_given, given_floating);
  const MatrixXf given = by_given.leftCols(loads), given_of_floating = given_floating.leftCols(loads);
  MatrixXf potentials = on_target_.leftCols(loads) - by_target.transpose() * given;
  const MatrixXf energies = target.functions().energies().cast<float>();
  MatrixXf schur = energies;
  schur.selfadjointView<Eigen::Lower>().rankUpdate(by_target.transpose(), -1.0F);
  if (target_floating.rows() > 0) {
    potentials += target_floating.transpose() * given_of_floating;
    schur.selfadjointView<Eigen::Lower>().rankUpdate(target_floating.transpose(), 1.0F);
  }
  const VectorXf scales = energies.diagonal().cwiseSqrt().cwiseInverse();
  schur = (scales.asDiagonal() * schur * scales.asDiagonal()).eval();
  factorise_in_place(schur);
  MatrixXf right(functions, loads + floating);
  right.leftCols(loads) = potentials;
  for (Index k = 0; k < floating; ++k)
    right.col(loads + k) = target.net().col(target.floating()[static_cast<std::size_t>(k)]).cast<float>();
  right = (scales.asDiagonal() * right).eval();
  schur.triangularView<Eigen::Lower>().solveInPlace(right);
  MatrixXf answer = right.leftCols(loads);
  if (floating > 0) {
    const MatrixXf own = right.rightCols(floating);
    MatrixXd block = (own.transpose() * own).cast<double>();
    block.diagonal() += target.to_ground();
    answer -= own * block.llt().solve((own.transpose() * answer).cast<double>().eval()).cast<float>();
  }
  // Without floating targets both are the same; with them the second one is the first one's projection.
  const MatrixXd changes = (right.leftCols(loads).transpose() * answer).cast<double>();
  schur.transpose().triangularView<Eigen::Upper>().solveInPlace(answer);
  const MatrixXf on_target = scales.asDiagonal() * answer;
  const MatrixXf on_machine = charges(
      -by_target * on_target, target_floating.rows() > 0 ? MatrixXf(-target_floating * on_target)
                                                         : MatrixXf(0, loads));  // answer the target's
  const MatrixXf background = charges(-given, -given_of_floating);               // that answer the given ones
  // The defect of the functions is estimated by that of their sums.
  const MatrixXd lacking = target.coarse().defects(on_target, energies * on_target);
  MatrixXd unanswered = MatrixXd::Zero(2 * loads, 2 * loads);
  double excess = 1;
  for (std::size_t k = 0; k < machine.links().size(); ++k) {
    const MachineLink& link = machine.links()[k];
    const Index size = first_[k + 1] - first_[k];
    MatrixXf own(size, 2 * loads);
    own << on_machine.middleRows(first_[k], size), background.middleRows(first_[k], size);
    unanswered += link.coarse().defects(own, link.energies() * own);
    if (!link.loads().empty())
      excess = std::max(excess, link.excess());
  }
  const MatrixXf shifts = (on_target.transpose() * on_target_.rightCols(loads) +
                           on_machine.transpose() * on_machine_.rightCols(loads)) *
                          static_cast<float>(std::sqrt(excess));
  const double near = nearness(machine, target, links, frame);
  const auto root = [](const MatrixXd& defects, Index load) {
    return std::sqrt(std::max(defects(load, load), 0.0));
  };
  solved_.clear();
  for (const MachineAtRest::OfReading& reading : machine.readings()) {
    const Index sense = reading.sense, drive = reading.drive;
    const double value = reading.sign * changes(sense, drive);
    const double parts =
        root(lacking, sense) * root(lacking, drive) + root(unanswered, sense) * root(unanswered, drive) +
        root(unanswered, sense) * root(unanswered, loads + drive) +
        root(unanswered, drive) * root(unanswered, loads + sense) + std::abs(shifts(sense, drive)) +
        std::abs(shifts(drive, sense)) + target.error() * std::abs(value);
    solved_.push_back({value, std::min(safety_of_links * parts * std::sqrt(std::max(near, 1.0)),
                                       std::max(safety_of_links * parts, std::abs(value)))});
  }
  return solved_;
}

}  // namespace fringe::detail
