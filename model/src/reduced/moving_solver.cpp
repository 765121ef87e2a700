#include "reduced/moving_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "numeric/infinity.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;
using Eigen::VectorXf;

/// Ratio of the stated error of a background to the sum of its parts, that of changes.
constexpr double stated_per_parts = 2;

/// Part of the diagonal that is added, growing until the matrix is positive definite: rounding of single
/// precision.
constexpr float least_ridge_of_links = 1e-6F;

/// Largest part of the diagonal that may be added: where more is needed, charges lie in each other.
constexpr float most_ridge_of_links = 2;

/// Fills and factorises with so much on the diagonal that a matrix is positive definite. Returns the part
/// that was added, or nothing if what may be added does not suffice.
template <typename Attempt>
std::optional<float> with_ridge(const Attempt& is_factorised) {
  for (float ridge = least_ridge_of_links; ridge <= most_ridge_of_links; ridge *= 10)
    if (is_factorised(ridge))
      return ridge;
  return std::nullopt;
}

/// Adds the energy of charges (columns) that was added to the diagonal of their matrix, if this is more than
/// rounding.
void add_energy_of_ridge(float ridge, const MatrixXf& energies, const MatrixXf& charges, MatrixXd& defects) {
  if (ridge > least_ridge_of_links)
    defects += (ridge * (charges.transpose() * (energies.diagonal().asDiagonal() * charges))).cast<double>();
}

/// Multiplies a matrix by vectors, one after the other: for several at once Eigen may allocate memory.
void multiply(const MatrixXf& matrix, const MatrixXf& vectors, MatrixXf& products) {
  products.resize(matrix.rows(), vectors.cols());
  for (Index column = 0; column < vectors.cols(); ++column)
    products.col(column).noalias() = matrix * vectors.col(column);
}

Index in_whole_blocks(Index count) {
  return (count + PackedFactor::block - 1) / PackedFactor::block * PackedFactor::block;
}

}  // namespace

/// Evaluates the couplings of what has moved against each other.
void MovingSolver::couple(const LinkedMachine& machine, const LinkTables& tables, const TargetAtRest& target,
                          const PoseOfMachine& pose) {
  const std::size_t links = pose.links.size();
  const bool is_first = couplings_.empty();
  couplings_.resize(links * (links + 1) / 2);
  const auto functions_of = [&](std::size_t group) -> const ChargeFunctions& {
    return group < links ? machine.links()[group].functions() : target.functions();
  };
  std::size_t pair = 0;
  for (std::size_t a = 0; a < links; ++a)
    for (std::size_t b = a + 1; b <= links; ++b, ++pair) {
      LinkCoupling& coupling = couplings_[pair];
      const Isometry3d relative = pose.of(b).inverse(Eigen::Isometry) * pose.links[a];
      if (!is_first && are_equal(coupling.relative, relative))
        continue;
      coupling.relative = relative;
      coupler_.couple(functions_of(a), functions_of(b), relative, coupling.functions);
      tables.of(a).write(functions_of(b), relative.inverse(Eigen::Isometry), coupling.given_first, beside_);
      if (b < links)
        tables.of(b).write(functions_of(a), relative, coupling.given_second, beside_);
    }
}

/// Finds what depends on no pose.
void MovingSolver::prepare(const LinkedMachine& machine, const TargetAtRest& target) {
  if (!first_.empty())
    return;
  first_.push_back(0);
  for (const MachineLink& link : machine.links()) {
    first_.push_back(first_.back() + index_of(link.functions().count()));
    floating_ += link.net().cols();
  }
  first_target_ = in_whole_blocks(first_.back());
  energies_of_target_ = target.functions().energies().cast<float>();
  first_.push_back(first_.back() + energies_of_target_.rows());
  scales_.resize(first_.back());
  for (std::size_t k = 0; k < machine.links().size(); ++k)
    scales_.segment(first_[k], first_[k + 1] - first_[k]) = machine.links()[k].energies().diagonal();
  scales_.tail(energies_of_target_.rows()) = energies_of_target_.diagonal();
  scales_ = scales_.cwiseSqrt().cwiseInverse().eval();
  of_links_.resize(machine.links().size());
}

/// Adds up the potentials of the charges that are given on the links.
void MovingSolver::add_given(const LinkedMachine& machine) {
  const std::size_t links = machine.links().size();
  const Index loads = machine.loads();
  given_.setZero(first_.back(), 2 * loads);
  mutual_.setZero(loads, 2 * loads);
  const auto add = [&](const MachineLink& link, const TrianglePotentials& potentials, std::size_t to) {
    const Index first = first_[to], size = first_[to + 1] - first, own = index_of(link.loads().size());
    for (Index k = 0; k < own; ++k) {
      const Index load = link.loads()[static_cast<std::size_t>(k)];
      given_.col(load).segment(first, size) += potentials.col(k).head(size);
      given_.col(loads + load).segment(first, size) += potentials.col(own + k).head(size);
      // The rows behind those of the functions belong to the loads of a link.
      for (Index other = 0; to < links && other < index_of(machine.links()[to].loads().size()); ++other) {
        const Index on = machine.links()[to].loads()[static_cast<std::size_t>(other)];
        mutual_(on, load) += potentials(size + other, k);
        mutual_(on, loads + load) += potentials(size + other, own + k);
      }
    }
  };
  std::size_t pair = 0;
  for (std::size_t a = 0; a < links; ++a)
    for (std::size_t b = a + 1; b <= links; ++b, ++pair) {
      add(machine.links()[a], couplings_[pair].given_first, b);
      if (b < links)
        add(machine.links()[b], couplings_[pair].given_second, a);
    }
}

/// Writes the columns of the links' functions.
void MovingSolver::fill_machine(const LinkedMachine& machine, float ridge) {
  const std::size_t links = machine.links().size();
  const Index loads = machine.loads();
  const auto scales = [&](std::size_t group) { return scales_.data() + first_[group]; };
  std::size_t pair = 0;
  Index floating = 0;
  for (std::size_t a = 0; a < links; ++a) {
    const MachineLink& link = machine.links()[a];
    const Index first = first_[a], size = first_[a + 1] - first;
    for (Index column = 0; column < size; ++column) {
      factor_(first + column, first + column) = 1 + ridge;
      const float own = scales(a)[column];
      for (Index row = column + 1; row < size; ++row)
        factor_(first + row, first + column) = own * scales(a)[row] * link.energies()(row, column);
      for (Index load = 0; load < loads; ++load)
        factor_(side_row(load), first + column) = own * given_(first + column, load);
      for (Index k = 0; k < link.net().cols(); ++k)
        factor_(side_row(loads + floating + k), first + column) = own * link.net()(column, k);
    }
    floating += link.net().cols();
    for (std::size_t b = a + 1; b <= links; ++b, ++pair) {
      const MatrixXf& functions = couplings_[pair].functions;
      const Index first_row = b < links ? first_[b] : first_target_;
      for (Index column = 0; column < size; ++column)
        for (Index row = 0; row < functions.rows(); ++row)
          factor_(first_row + row, first + column) =
              scales(a)[column] * scales(b)[row] * functions(row, column);
    }
  }
  for (Index k = of_machine(); k < first_target_; ++k)
    factor_(k, k) = 1;
}

/// Writes the columns of the target's functions, with what the machine's floating conductors take.
void MovingSolver::fill_target(const TargetAtRest& target, float ridge) {
  const Index targets = energies_of_target_.rows(), loads = given_.cols() / 2;
  const float* const scales = scales_.data() + of_machine();
  for (Index column = 0; column < targets; ++column) {
    for (Index row = column; row < targets; ++row) {
      float& entry = factor_(target_row(row), target_row(column));
      entry = row == column ? 1 + ridge : scales[column] * scales[row] * energies_of_target_(row, column);
      if (floating_ > 0)
        entry += static_cast<float>(on_floating_.col(row).dot(on_floating_.col(column)));
    }
    for (Index load = 0; load < loads; ++load) {
      float& entry = factor_(side_row(load), target_row(column));
      entry = scales[column] * given_(of_machine() + column, load);
      if (floating_ > 0)
        entry += static_cast<float>(on_floating_.col(column).dot(on_floating_.col(targets + load)));
    }
    for (std::size_t k = 0; k < target.floating().size(); ++k)
      factor_(side_row(loads + floating_ + index_of(k)), target_row(column)) =
          scales[column] * static_cast<float>(target.net()(column, target.floating()[k]));
  }
  for (Index k = target_row(targets); k < factor_.rows(); ++k)
    factor_(k, k) = 1;
}

/// Factorises the matrix, first of the machine and then of the target with the machine grounded, and solves
/// it for the right sides. Returns false if that is not possible.
bool MovingSolver::factorise(const LinkedMachine& machine, const TargetAtRest& target) {
  const Index loads = machine.loads(), blocks_of_machine = first_target_ / PackedFactor::block,
              blocks = blocks_of_machine + in_whole_blocks(energies_of_target_.rows()) / PackedFactor::block;
  ridge_ = with_ridge([&](float ridge) {
    factor_.resize(blocks, loads + floating_ + index_of(target.floating().size()));
    fill_machine(machine, ridge);
    return factor_.factorise(0, blocks_of_machine);
  });
  if (!ridge_)
    return false;
  if (floating_ > 0)
    solve_floating(machine);
  ridge_of_target_ = with_ridge([&](float ridge) {
    fill_target(target, ridge);
    return factor_.factorise(blocks_of_machine, blocks);
  });
  return ridge_of_target_.has_value();
}

/// Finds what the targets' functions and the loads put on the machine's conductors that float.
void MovingSolver::solve_floating(const LinkedMachine& machine) {
  const Index targets = energies_of_target_.rows(), loads = machine.loads();
  const auto product = [&](Index a, Index b) {
    double sum = 0;
    for (Index k = 0; k < of_machine(); ++k)
      sum += static_cast<double>(factor_(a, k)) * factor_(b, k);
    return sum;
  };
  floating_block_.resize(floating_, floating_);
  on_floating_.resize(floating_, targets + loads);
  for (Index k = 0; k < floating_; ++k) {
    const Index own = side_row(loads + k);
    for (Index other = 0; other < floating_; ++other)
      floating_block_(k, other) = product(own, side_row(loads + other));
    for (Index function = 0; function < targets; ++function)
      on_floating_(k, function) = product(own, target_row(function));
    for (Index load = 0; load < loads; ++load)
      on_floating_(k, targets + load) = product(own, side_row(load));
  }
  Index at = 0;
  for (const MachineLink& link : machine.links()) {
    floating_block_.diagonal().segment(at, link.to_ground().size()) += link.to_ground();
    at += link.to_ground().size();
  }
  of_floating_.compute(floating_block_);
  of_floating_.matrixL().solveInPlace(on_floating_);
}

/// Finds the readings without targets: what each link carries alone, less the energies that these have with
/// each other, and what the links answer.
void MovingSolver::find_backgrounds(const LinkedMachine& machine) {
  const Index loads = machine.loads(), targets = energies_of_target_.rows();
  own_.setZero(loads, loads);
  for (const MachineLink& link : machine.links())
    for (std::size_t a = 0; a < link.loads().size(); ++a)
      for (std::size_t b = 0; b < link.loads().size(); ++b)
        own_(link.loads()[a], link.loads()[b]) += link.own()(index_of(a), index_of(b));
  backgrounds_ = own_ - (mutual_.leftCols(loads) + mutual_.leftCols(loads).transpose()) / 2;
  for (Index a = 0; a < loads; ++a)
    for (Index b = 0; b < loads; ++b) {
      for (Index k = 0; k < of_machine(); ++k)
        backgrounds_(a, b) += static_cast<double>(factor_(side_row(a), k)) * factor_(side_row(b), k);
      if (floating_ > 0)
        backgrounds_(a, b) -= on_floating_.col(targets + a).dot(on_floating_.col(targets + b));
    }
}

/// Finds the changes, with the net charges that floating targets may have.
void MovingSolver::solve(const TargetAtRest& target) {
  const Index targets = energies_of_target_.rows(), loads = given_.cols() / 2,
              floating = index_of(target.floating().size());
  right_.resize(targets, loads);
  net_.resize(targets, floating);
  for (Index function = 0; function < targets; ++function) {
    for (Index load = 0; load < loads; ++load)
      right_(function, load) = factor_(side_row(load), target_row(function));
    for (Index k = 0; k < floating; ++k)
      net_(function, k) = factor_(side_row(loads + floating_ + k), target_row(function));
  }
  answer_ = right_;
  floating_charges_.take(net_, net_, target.to_ground(), answer_);
  // Without floating targets both are the same; with them the second one is the first one's projection.
  changes_.noalias() = right_.transpose() * answer_;
}

/// Finds the charges on the target and the machine's answers to them and to the given charges.
void MovingSolver::find_charges() {
  const Index machine = of_machine(), targets = energies_of_target_.rows(), loads = answer_.cols(),
              sets = 2 * loads, blocks_of_machine = first_target_ / PackedFactor::block;
  vectors_.assign(static_cast<std::size_t>(factor_.rows() * sets), 0.0F);
  const auto vector = [&](Index row, Index set) -> float& {
    return vectors_[static_cast<std::size_t>(row * sets + set)];
  };
  for (Index load = 0; load < loads; ++load) {
    for (Index function = 0; function < targets; ++function)
      vector(target_row(function), load) = static_cast<float>(answer_(function, load));
    for (Index function = 0; function < machine; ++function)
      vector(function, loads + load) = -factor_(side_row(load), function);
  }
  factor_.solve_transposed(blocks_of_machine, factor_.rows() / PackedFactor::block, vectors_, sets);
  charges_on_target_.resize(targets, loads);
  for (Index load = 0; load < loads; ++load)
    for (Index function = 0; function < targets; ++function)
      charges_on_target_(function, load) = vector(target_row(function), load);
  if (floating_ > 0) {
    // Conductors that float take their part of what targets and loads put on the machine.
    taken_.setZero(floating_, sets);
    for (Index load = 0; load < loads; ++load) {
      for (Index function = 0; function < targets; ++function)
        taken_.col(load) -= on_floating_.col(function) * charges_on_target_(function, load);
      taken_.col(loads + load) = -on_floating_.col(targets + load);
    }
    of_floating_.matrixU().solveInPlace(taken_);
    for (Index set = 0; set < sets; ++set)
      for (Index k = 0; k < floating_; ++k)
        for (Index function = 0; function < machine; ++function)
          vector(function, set) -=
              static_cast<float>(taken_(k, set)) * factor_(side_row(loads + k), function);
  }
  factor_.solve_transposed(0, blocks_of_machine, vectors_, sets);
  answered_.resize(machine, loads);
  background_.resize(machine, loads);
  for (Index load = 0; load < loads; ++load)
    for (Index function = 0; function < machine; ++function) {
      answered_(function, load) = scales_[function] * vector(function, load);
      background_(function, load) = scales_[function] * vector(function, loads + load);
    }
  charges_on_target_.array().colwise() *= scales_.tail(targets).array();
}

/// States errors by what sums of functions lack, which estimates what the functions do.
void MovingSolver::state_errors(const LinkedMachine& machine, const TargetAtRest& target, double nearness) {
  const Index loads = machine.loads();
  multiply(energies_of_target_, charges_on_target_, potentials_);
  target.coarse().find_defects(charges_on_target_, potentials_, lacking_);
  add_energy_of_ridge(*ridge_of_target_, energies_of_target_, charges_on_target_, lacking_.defects);
  unanswered_.setZero(2 * loads, 2 * loads);
  double excess = 1, facets_of_given = 0, of_own = 0;
  for (std::size_t k = 0; k < machine.links().size(); ++k) {
    const MachineLink& link = machine.links()[k];
    facets_of_given = std::max(facets_of_given, link.functions().facet_effect_of_given());
    OfLink& own = of_links_[k];
    const Index size = first_[k + 1] - first_[k];
    own.charges.resize(size, 2 * loads);
    own.charges.leftCols(loads) = answered_.middleRows(first_[k], size);
    own.charges.rightCols(loads) = background_.middleRows(first_[k], size);
    multiply(link.energies(), own.charges, own.potentials);
    link.coarse().find_defects(own.charges, own.potentials, own.lacking);
    unanswered_ += own.lacking.defects;
    add_energy_of_ridge(*ridge_, link.energies(), own.charges, unanswered_);
    if (link.loads().empty())
      continue;
    excess = std::max(excess, link.excess());
    of_own = std::max(of_own, link.own_error());
  }
  const auto lacking = given_.rightCols(loads);
  const auto on_machine = lacking.topRows(of_machine());
  shifts_.noalias() = charges_on_target_.transpose() * lacking.bottomRows(charges_on_target_.rows());
  shifts_.noalias() += answered_.transpose() * on_machine;
  shifts_ *= static_cast<float>(std::sqrt(excess));
  shifts_of_background_.noalias() = background_.transpose() * on_machine;
  shifts_of_background_ += mutual_.rightCols(loads).cast<float>();
  shifts_of_background_ *= static_cast<float>(std::sqrt(excess));
  solved_.clear();
  for (const OfReading& reading : machine.readings()) {
    const Index sense = reading.sense, drive = reading.drive;
    const double change = reading.sign * changes_(sense, drive);
    const double others = shared_energy(unanswered_, sense, drive) +
                          shared_energy(unanswered_, sense, loads + drive) +
                          shared_energy(unanswered_, drive, loads + sense) + std::abs(shifts_(sense, drive)) +
                          std::abs(shifts_(drive, sense));
    const double of_facets =
        target.functions().facet_effect(charges_on_target_.col(sense), charges_on_target_.col(drive));
    const double error = stated_error(
        change, target,
        {shared_energy(lacking_.defects, sense, drive), others, of_facets, facets_of_given, nearness});
    const double of_background = shared_energy(unanswered_, loads + sense, loads + drive) +
                                 std::abs(shifts_of_background_(sense, drive)) +
                                 std::abs(shifts_of_background_(drive, sense));
    solved_.push_back(
        {change, error, reading.sign * backgrounds_(sense, drive),
         stated_per_parts * of_background + of_own * std::sqrt(own_(sense, sense) * own_(drive, drive))});
  }
}

const std::vector<SolvedReading>& MovingSolver::solved(const LinkedMachine& machine, const LinkTables& tables,
                                                       const TargetAtRest& target,
                                                       const PoseOfMachine& pose) {
  couple(machine, tables, target, pose);
  prepare(machine, target);
  add_given(machine);
  if (!factorise(machine, target)) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    solved_.assign(machine.readings().size(), {unknown, infinity, unknown, infinity});
    return solved_;
  }
  find_backgrounds(machine);
  solve(target);
  find_charges();
  state_errors(machine, target, nearness(machine, target, pose));
  return solved_;
}

std::vector<GroupWrenches> MovingSolver::wrenches(const LinkedMachine& machine, const LinkTables& tables,
                                                  const TargetAtRest& target, const PoseOfMachine& poses) {
  const std::size_t links = machine.links().size();
  const std::vector<OfReading>& readings = machine.readings();
  const Index loads = machine.loads();
  const auto functions_of = [&](std::size_t group) -> const ChargeFunctions& {
    return group < links ? machine.links()[group].functions() : target.functions();
  };
  const auto of_link = [&](const MatrixXf& charges, std::size_t link) -> MatrixXf {
    return charges.middleRows(first_[link], first_[link + 1] - first_[link]);
  };
  // The forces on charges of a group's functions in the fields of what a link carries alone, in the world.
  const auto by_given = [&](std::size_t group, const MatrixXf& charges, const Isometry3d& pose,
                            std::size_t link) {
    std::vector<Wrench> found(readings.size());
    tables.of(link).find_forces(functions_of(group), pose, loads, machine.links()[link].loads(), beside_,
                                forces_);
    add_wrenches(readings, charges, forces_, found);
    for (Wrench& wrench : found)
      wrench = in_outer_frame(wrench, poses.links[link]);
    return found;
  };
  std::vector<GroupWrenches> result;
  for (std::size_t b = 0; b < links; ++b)
    for (std::size_t a = 0; a <= links; ++a) {
      const bool is_target = a == links;
      if (a >= b && !is_target)
        continue;
      const MatrixXf charges = is_target ? charges_on_target_ : of_link(answered_, a);
      const MatrixXf of_other = of_link(answered_, b);
      const Isometry3d pose = poses.links[b].inverse(Eigen::Isometry) * poses.of(a);
      std::vector<Wrench> wrenches = by_given(a, charges, pose, b), by_answers(readings.size());
      // The energy with targets less that without, as a sum of products with what answers the targets: with
      // the difference of two nearly equal forces nothing would be left in single precision.
      MatrixXf fields(of_other.rows(), is_target ? loads : 2 * loads);
      fields.leftCols(loads) = of_other - of_link(background_, b);
      if (!is_target)
        fields.rightCols(loads) = of_other;
      coupler_.find_forces(functions_of(a), functions_of(b), pose, fields, forces_);
      add_wrenches(readings, charges, forces_.leftCols(loads), by_answers);
      if (!is_target) {
        // Without targets there is no charge on these, and they carry nothing for the loads.
        add_wrenches(readings, -of_link(background_, a), forces_.rightCols(loads), by_answers);
        const std::vector<Wrench> opposite = by_given(b, of_other, pose.inverse(Eigen::Isometry), a);
        for (std::size_t k = 0; k < readings.size(); ++k)
          wrenches[k] += -1.0 * opposite[k];
      }
      for (std::size_t k = 0; k < readings.size(); ++k)
        wrenches[k] += -1.0 * in_outer_frame(by_answers[k], poses.links[b]);
      result.push_back({is_target ? LinkedMachine::none : a, b, std::move(wrenches)});
    }
  return result;
}

}  // namespace fringe::detail
