#include "reduced/tabulated_solver.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// Largest number of modes: with them a hand's charges 2 cm from an arm lose less than 1e-3 of the energy of
/// its answer.
constexpr Index most_modes = 112;

/// Largest number of places for which the modes are chosen.
constexpr std::size_t most_places = 1500;

/// Growth of the number of cells after which the modes are chosen anew.
constexpr std::size_t regional_growth = 2;

/// The coarsest level of the targets' points: with a few points in a cell, more cost little.
constexpr std::size_t coarsest_target_level = 1;

/// Largest number of steps of the conjugate gradients for the charges on targets.
constexpr int most_charge_steps = 10;

/// Part of the accuracy asked for by which a change may alter in their last step.
constexpr double last_step_part = 0.1;

/// Calls a function with every point of the target, the number of its function and its share.
template <typename Visit>
void visit_points(const TabulatedMachine& machine, const TargetAtRest& target, const Isometry3d& pose,
                  const Visit& visit) {
  const ChargeFunctions& functions = target.functions();
  functions.visit_points(
      pose,
      [&](std::size_t function) {
        return std::max(functions.level(function, pose, machine.link().functions().boxes()),
                        coarsest_target_level);
      },
      [&](const Vector3d& at, std::size_t function, const FunctionPoints& points, std::size_t k) {
        visit(at, function, points.shares[k]);
      });
}

}  // namespace

TabulatedMachine::TabulatedMachine(const LinkedMachine& machine, const TargetAtRest& target)
    : machine_(machine), potentials_(link().functions()), table_(potentials_, target.size()) {}

void TabulatedMachine::extend(const TargetAtRest& target, std::span<const Isometry3d> poses,
                              std::size_t threads) {
  const auto add = [&] {
    bool have_cells = true;
    for (const Isometry3d& pose : poses)
      visit_points(*this, target, pose, [&](const Vector3d& at, std::size_t, float) {
        have_cells = table_.add(at) && have_cells;
      });
    return have_cells;
  };
  if (table_.make_room_for(add))
    places_ = 0;
  if (modes_.charges.size() > 0 && table_.count() < regional_growth * places_) {
    table_.fill(modes_.charges, threads);
    return;
  }
  places_ = table_.count();
  std::vector<Vector3d> places = table_.centres();
  const std::size_t step = places.size() / most_places + 1;
  for (std::size_t k = 0; k * step < places.size(); ++k)
    places[k] = places[k * step];
  places.resize((places.size() + step - 1) / step);
  // Without cells, as in contact everywhere, the modes are those of the targets' own places.
  if (places.empty())
    for (std::size_t function = 0; function < target.functions().count(); ++function)
      places.push_back(poses.front() * target.functions().centre(function));
  if (root_.size() == 0)
    root_ = root_of_answers(link());
  modes_ = answer_modes(link(), root_, potentials_, places, most_modes, threads);
  table_.forget_values();
  table_.fill(modes_.charges, threads);
}

const std::vector<SolvedReading>& TabulatedSolver::solved(const TabulatedMachine& machine,
                                                          const TargetAtRest& target, const Isometry3d& pose,
                                                          double rtol) {
  prepare(machine, target);
  find_potentials(machine, target, pose);
  start(machine, target);
  const auto functions = static_cast<std::ptrdiff_t>(target.functions().count());
  const auto& kernels = best_kernels<NodeKernels>();
  const std::vector<OfReading>& readings = machine.machine().readings();
  before_.assign(readings.size(), 0);
  for (int step = 0;; ++step) {
    solve_form(target);
    solved_.clear();
    double largest = 0;
    for (const OfReading& reading : readings) {
      const double change = reading.sign * changes_(reading.sense, reading.drive);
      const double step_change = std::abs(change - before_[solved_.size()]);
      largest = std::max(largest, step_change / std::abs(change));
      solved_.push_back({change, step_change, 0, 0});
    }
    if (!(largest > last_step_part * rtol) || step + 1 == most_charge_steps)
      break;
    for (std::size_t k = 0; k < solved_.size(); ++k)
      before_[k] = solved_[k].change;
    auto chosen = chosen_.topRows(count_);
    chosen = coefficients_.topRows(count_).cast<float>();
    residual_.noalias() = images_.topLeftCorner(right_.rows(), count_) * chosen;
    residual_ = right_ - residual_;
    const Index first = count_;
    for (Index load = 0; load < right_.cols(); ++load) {
      own_.col(count_).head(right_.rows()) = residual_.col(load);
      kernels.multiply(target.inverse().data(), functions, own_.col(count_).data(),
                       charges_.col(count_).data());
      add_direction(machine);
    }
    extend_form(first);
  }
  state_errors(machine, target, nearness(machine.machine().used(0), target, pose));
  return solved_;
}

/// Gives all arrays the sizes that the machine and the targets may need.
void TabulatedSolver::prepare(const TabulatedMachine& machine, const TargetAtRest& target) {
  const Index functions = index_of(target.functions().count()), loads = machine.machine().loads(),
              floating = index_of(target.floating().size()), sides = loads + floating,
              width = whole_blocks(machine.given() + machine.modes().charges.cols()),
              most = target.conductors() + loads + (most_charge_steps - 1) * sides,
              padded = whole_blocks(functions) + node_block;
  loads_ = loads;
  seen_.resize(functions, width);
  none_.assign(static_cast<std::size_t>(width), 0.0F);
  sums_.resize(none_.size());
  of_modes_.resize(none_.size());
  of_rows_.resize(target.functions().count());
  right_.resize(functions, sides);
  residual_.resize(functions, sides);
  if (charges_.rows() != padded || charges_.cols() != most)
    for (MatrixXf* matrix : {&charges_, &own_, &images_})
      matrix->setZero(padded, most);
  moments_.resize(most, width);
  form_.resize(most, most);
  factor_.resize(most, most);
  column_.resize(most);
  energies_.resize(most, most);
  for (MatrixXd* matrix : {&sides_, &coefficients_})
    matrix->resize(most, sides);
  chosen_.resize(most, sides);
  charged_.resize(most, loads);
  changes_.resize(loads, loads);
  before_.reserve(machine.machine().readings().size());
  solved_.reserve(before_.capacity());
}

/// Finds the potentials of everything that is tabulated on each function of the target.
void TabulatedSolver::find_potentials(const TabulatedMachine& machine, const TargetAtRest& target,
                                      const Isometry3d& pose) {
  seen_.setZero();
  outside_.clear();
  table_potentials_.start(machine.table(), seen_);
  visit_points(machine, target, pose, [&](const Vector3d& at, std::size_t function, float share) {
    if (!table_potentials_.add(at, index_of(function), share))
      outside_.push_back({at, index_of(function), share});
  });
  table_potentials_.finish();
  if (!outside_.empty())
    find_outside(machine);
}

/// Adds the potentials at the points that are in no cell.
void TabulatedSolver::find_outside(const TabulatedMachine& machine) {
  std::vector<Vector3d> places;
  places.reserve(outside_.size());
  for (const Outside& point : outside_)
    places.push_back(point.at);
  const OutsidePotentials::Values values = machine.potentials().at(places, true, &machine.modes().charges, 1);
  for (std::size_t k = 0; k < outside_.size(); ++k) {
    auto row = seen_.row(outside_[k].function);
    row.head(values.of_given.cols()) += outside_[k].share * values.of_given.row(index_of(k));
    row.segment(values.of_given.cols(), values.of_functions.cols()) +=
        outside_[k].share * values.of_functions.row(index_of(k));
  }
}

const std::vector<Wrench>& TabulatedSolver::wrenches(const TabulatedMachine& machine,
                                                     const TargetAtRest& target, const Isometry3d& pose) {
  const Index given = machine.given(), modes = machine.modes().charges.cols();
  fields_.setZero(index_of(machine.table().width()), loads_);
  fields_.topRows(loads_).setIdentity();
  fields_.middleRows(given, modes) = all_moments_.middleRows(given, modes);
  forces_.setZero(6 * seen_.rows(), loads_);
  outside_.clear();
  table_forces_.start(machine.table(), fields_);
  visit_points(machine, target, pose, [&](const Vector3d& at, std::size_t function, float share) {
    if (!table_forces_.add(at, function, share, forces_))
      outside_.push_back({at, index_of(function), share});
  });
  table_forces_.finish(forces_);
  if (!outside_.empty())
    find_outside_forces(machine);
  wrenches_.assign(solved_.size(), {});
  add_wrenches(machine.machine().readings(), on_target_, forces_, wrenches_);
  return wrenches_;
}

/// Adds the forces at the points that are in no cell, by differences of potentials.
void TabulatedSolver::find_outside_forces(const TabulatedMachine& machine) {
  /// Step of the differences, over the side of the least cells: the field is smooth at this distance from the
  /// machine, and single precision leaves differences enough digits.
  constexpr double steps_per_side = 0.05;
  const double step = steps_per_side * machine.table().least_side();
  const FunctionCharges answers(machine.modes().charges *
                                fields_.middleRows(machine.given(), machine.modes().charges.cols()));
  OutsidePotentials::Scratch scratch;
  for (const Outside& point : outside_) {
    // All six are in one block, so that they see the same points of the machine.
    std::array<Vector3d, 6> around;
    for (std::size_t k = 0; k < around.size(); ++k)
      around[k] = point.at + (k % 2 == 0 ? step : -step) * Vector3d::Unit(index_of(k / 2));
    machine.potentials().evaluate(around, true, &answers, scratch);
    for (Index load = 0; load < loads_; ++load) {
      const std::size_t block = static_cast<std::size_t>(load) * OutsidePotentials::block;
      const auto potential = [&](std::size_t k) {
        return static_cast<double>(scratch.of_given[block + k]) + scratch.of_charges[block + k];
      };
      const Vector3d force =
          point.share / (2 * step) *
          Vector3d(potential(0) - potential(1), potential(2) - potential(3), potential(4) - potential(5));
      forces_.col(load).segment<3>(6 * point.function) += force;
      forces_.col(load).segment<3>(6 * point.function + 3) += point.at.cross(force);
    }
  }
}

/// Begins with the charges of the target's conductors at unit potentials and those that the loads displace.
void TabulatedSolver::start(const TabulatedMachine& machine, const TargetAtRest& target) {
  const auto& kernels = best_kernels<NodeKernels>();
  const Index functions = seen_.rows(), floating = index_of(target.floating().size());
  right_.leftCols(loads_) = seen_.leftCols(loads_);
  for (Index k = 0; k < floating; ++k)
    right_.col(loads_ + k) = target.net().col(target.floating()[static_cast<std::size_t>(k)]).cast<float>();
  moments_.setZero();
  count_ = 0;
  for (Index k = 0; k < target.conductors(); ++k) {
    charges_.col(count_).head(functions) = target.equilibrium().col(k).cast<float>();
    own_.col(count_).head(functions) = target.net().col(k).cast<float>();
    add_direction(machine);
  }
  for (Index load = 0; load < loads_; ++load) {
    own_.col(count_).head(functions) = right_.col(load);
    kernels.multiply(target.inverse().data(), functions, own_.col(count_).data(),
                     charges_.col(count_).data());
    add_direction(machine);
  }
  extend_form(0);
}

/// Adds the direction whose charges and potentials are in the column behind the last one.
void TabulatedSolver::add_direction(const TabulatedMachine& machine) {
  const auto& kernels = best_kernels<NodeKernels>();
  const Index functions = seen_.rows(), width = seen_.cols(), given = machine.given();
  const NodeMatrix seen{seen_.data(), functions, width};
  float* const moments = moments_.row(count_).data();
  kernels.apply(seen, charges_.col(count_).data(), none_.data(), of_rows_.data(), moments);
  std::copy(moments, moments + width, of_modes_.begin());
  std::fill(of_modes_.begin(), of_modes_.begin() + given, 0.0F);
  kernels.apply(seen, charges_.col(count_).data(), of_modes_.data(), of_rows_.data(), sums_.data());
  images_.col(count_).head(functions) =
      own_.col(count_).head(functions) - Eigen::Map<const Eigen::VectorXf>(of_rows_.data(), functions);
  for (Index load = 0; load < loads_; ++load)
    sides_(count_, load) = moments[load];
  for (Index load = loads_; load < right_.cols(); ++load)
    sides_(count_, load) = charges_.col(count_).head(functions).dot(right_.col(load));
  ++count_;
}

/// Adds the energies of the directions from `before` on.
void TabulatedSolver::extend_form(Index before) {
  const Index functions = seen_.rows();
  auto energies = energies_.topLeftCorner(count_, count_ - before);
  energies.noalias() = charges_.topLeftCorner(functions, count_).transpose() *
                       images_.block(0, before, functions, count_ - before);
  form_.block(0, before, count_, count_ - before) = energies.cast<double>();
  form_.block(before, 0, count_ - before, before) =
      form_.block(0, before, before, count_ - before).transpose();
}

/// Solves the form for the coefficients by Cholesky's method, without the directions that depend on those
/// before, up to the rounding of single precision.
void TabulatedSolver::solve_coefficients() {
  /// Part of a direction's energy that rounding may leave.
  constexpr double rounding = 1e-6;
  const Index sides = right_.cols();
  auto factor = factor_.topLeftCorner(count_, count_);
  auto result = coefficients_.topRows(count_);
  factor.setZero();
  result = sides_.topRows(count_);
  for (Index k = 0; k < count_; ++k) {
    const double pivot = form_(k, k) - factor.row(k).head(k).squaredNorm();
    if (!(pivot > rounding * form_(k, k))) {
      factor.row(k).setZero();
      continue;
    }
    factor(k, k) = std::sqrt(pivot);
    const Index below = count_ - k - 1;
    auto product = column_.head(below);
    product.noalias() = factor.bottomLeftCorner(below, k) * factor.row(k).head(k).transpose();
    factor.col(k).tail(below) = (form_.col(k).segment(k + 1, below) - product) / factor(k, k);
  }
  for (Index k = 0; k < count_; ++k)
    for (Index side = 0; side < sides; ++side)
      result(k, side) =
          factor(k, k) > 0
              ? (result(k, side) - factor.row(k).head(k).dot(result.col(side).head(k))) / factor(k, k)
              : 0;
  for (Index k = count_ - 1; k >= 0; --k) {
    const Index below = count_ - k - 1;
    for (Index side = 0; side < sides && factor(k, k) > 0; ++side)
      result(k, side) =
          (result(k, side) - factor.col(k).tail(below).dot(result.col(side).tail(below))) / factor(k, k);
  }
}

/// Minimises the energy in the directions, with the net charges that floating targets may have.
void TabulatedSolver::solve_form(const TargetAtRest& target) {
  solve_coefficients();
  const Index floating = right_.cols() - loads_;
  auto charged = charged_.topRows(count_);
  charged = coefficients_.topLeftCorner(count_, loads_);
  floating_charges_.take(sides_.topRows(count_).rightCols(floating),
                         coefficients_.topRows(count_).rightCols(floating), target.to_ground(), charged);
  changes_.noalias() = sides_.topLeftCorner(count_, loads_).transpose() * charged;
}

void TabulatedSolver::state_errors(const TabulatedMachine& machine, const TargetAtRest& target,
                                   double nearness) {
  const Index functions = seen_.rows(), given = machine.given(), modes = machine.modes().charges.cols();
  auto chosen = chosen_.topLeftCorner(count_, loads_);
  chosen = charged_.topRows(count_).cast<float>();
  on_target_.noalias() = charges_.topLeftCorner(functions, count_) * chosen;
  potentials_.noalias() = own_.topLeftCorner(functions, count_) * chosen;
  target.coarse().find_defects(on_target_, potentials_, lacking_);
  // The moments with everything tabulated, a column for each load.
  all_moments_.noalias() = moments_.topRows(count_).transpose() * chosen;
  const auto of_modes = all_moments_.middleRows(given, modes);
  const auto last = of_modes.bottomRows(modes / 4);
  answers_.noalias() = machine.modes().missing * of_modes;
  unanswered_.noalias() = of_modes.transpose() * answers_;
  unanswered_.noalias() += last.transpose() * last;
  // The error of the given potentials is estimated by what fewer panels lack, and more where the panels are
  // too few to tell how fast it falls.
  shifts_ = all_moments_.middleRows(loads_, loads_).transpose() *
            static_cast<float>(std::sqrt(std::max(machine.link().excess(), 1.0)));
  for (std::size_t k = 0; k < solved_.size(); ++k) {
    const auto [sense, drive, sign] = machine.machine().readings()[k];
    const double others = solved_[k].error + shared_energy(unanswered_, sense, drive) +
                          std::abs(shifts_(sense, drive)) + std::abs(shifts_(drive, sense));
    solved_[k].error =
        stated_error(solved_[k].change, target,
                     {shared_energy(lacking_.defects, sense, drive), others,
                      target.functions().facet_effect(on_target_.col(sense), on_target_.col(drive)),
                      machine.link().functions().facet_effect_of_given(), nearness});
    std::tie(solved_[k].background, solved_[k].background_error) =
        machine.machine().background(machine.machine().readings()[k]);
  }
}

}  // namespace fringe::detail
