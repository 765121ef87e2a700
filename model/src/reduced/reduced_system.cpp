#include "reduced/reduced_system.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "bem/panel_mesh.hpp"
#include "numeric/interruption.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Least energy that orthogonalisation must leave of a vector, relative to its energy before. Less is
/// rounding noise.
constexpr double dependent = 1e-6;

/// Relative change of a capacitance below which no further step is made: single precision does not resolve
/// it.
constexpr double nothing = 1e-12;

/// Number of arrays that are allocated together.
constexpr std::size_t slots_in_block = 64;

/// Returns the factor by which `other` is a multiple of `vector`; 0 if, to single precision, it is not.
double parallel(const float* vector, const float* other, std::ptrdiff_t padded) {
  /// Squared sine of the angle below which two vectors are parallel.
  constexpr double nearly = 1e-8;
  const auto& kernels = best_kernels<NodeKernels>();
  const double square = kernels.dot(vector, vector, padded), product = kernels.dot(vector, other, padded);
  const double other_square = kernels.dot(other, other, padded);
  return product * product >= (1 - nearly) * square * other_square && square > 0 ? product / square : 0;
}

/// Adds to an entry of a symmetric matrix.
void add(MatrixXd& matrix, std::size_t row, std::size_t column, double change) {
  matrix(index_of(row), index_of(column)) += change;
  if (row != column)
    matrix(index_of(column), index_of(row)) += change;
}

}  // namespace

ReducedSystem::ReducedSystem(std::vector<ReducedBody> bodies, std::size_t sensors, std::size_t conductors,
                             std::optional<std::size_t> machine_bodies)
    : bodies_(std::move(bodies)), sensors_(sensors), conductors_(conductors), machine_bodies_(machine_bodies),
      pairs_(bodies_.size() * bodies_.size()) {
  while (sensor_bodies_ < bodies_.size() && bodies_[sensor_bodies_].conductor < sensors)
    ++sensor_bodies_;
}

float* ReducedSystem::slot() {
  const std::size_t block = slots_used_ / slots_in_block, at = slots_used_ % slots_in_block;
  if (block == blocks_.size())
    blocks_.push_back(std::make_unique<float[]>(slots_in_block * slot_size_));
  ++slots_used_;
  return blocks_[block].get() + at * slot_size_;
}

/// Makes the arrays long enough for all bodies' present levels. Returns false if they were not, and what they
/// held is lost.
bool ReducedSystem::fit_slots() {
  std::size_t size = 0;
  for (std::size_t body = 0; body < bodies_.size(); ++body)
    size = std::max(size, static_cast<std::size_t>(level(body).padded + 2 * node_block));
  if (size <= slot_size_)
    return true;
  slot_size_ = size;
  blocks_.clear();
  return false;
}

void ReducedSystem::begin() {
  slots_used_ = 0;
  used_ = extended_ = 0;
  equilibria_.clear();
  positive_definite_ = true;
  gram_.clear();
  factor_.clear();
  lay_residuals(residuals_);
  if (machine_bodies_)
    lay_residuals(background_residuals_);
}

void ReducedSystem::lay_residuals(Residuals& residuals) {
  for (std::vector<float*>* const arrays : {&residuals.moments, &residuals.corrections}) {
    arrays->resize(bodies_.size() * conductors_);
    for (float*& array : *arrays) {
      array = slot();
      std::fill_n(array, slot_size_, 0.0F);
    }
  }
}

/// Returns true if the vectors of the machine alone are those of its present levels and of as many steps.
bool ReducedSystem::knows_machine(const ReductionLimits& limits) const {
  if (!machine_ || machine_->least_steps != limits.least_steps)
    return false;
  for (std::size_t body = 0; body < machine_->levels.size(); ++body)
    if (machine_->levels[body] != bodies_[body].level)
      return false;
  return true;
}

/// Forgets all vectors but those of the machine alone, and their potentials on other bodies.
void ReducedSystem::return_to_machine() {
  const std::size_t bodies = machine_->levels.size();
  slots_used_ = machine_->slots;
  used_ = extended_ = machine_->vectors;
  equilibria_.resize(bodies);
  positive_definite_ = true;
  gram_.resize(used_ * (used_ + 1) / 2);
  factor_.resize(gram_.size());
  for (std::size_t k = 0; k < used_; ++k)
    std::fill(vectors_[k].potentials.begin() + index_of(bodies), vectors_[k].potentials.end(), nullptr);
}

ReducedSystem::Vector& ReducedSystem::new_vector(std::size_t body) {
  if (used_ == vectors_.size())
    vectors_.emplace_back();
  Vector& vector = vectors_[used_++];
  vector.body = body;
  vector.charge = slot();
  vector.moments = slot();
  vector.potentials.assign(bodies_.size(), nullptr);
  return vector;
}

/// Orthogonalises a charge and its moments against the body's basis.
void ReducedSystem::orthogonalise(std::size_t body, float* charge, float* moments) {
  const auto& kernels = best_kernels<NodeKernels>();
  const std::ptrdiff_t padded = level(body).padded;
  for (std::size_t k = 0; k < used_; ++k) {
    if (vectors_[k].body != body)
      continue;
    const float part = -kernels.dot(charge, vectors_[k].moments, padded);
    kernels.add(part, vectors_[k].charge, charge, padded);
    kernels.add(part, vectors_[k].moments, moments, padded);
  }
}

void ReducedSystem::add_equilibrium(std::size_t body) {
  const PreparedLevel& prepared = level(body);
  const double root = std::sqrt(bodies_[body].scale);
  equilibria_.push_back(used_);
  Vector& vector = new_vector(body);
  for (std::ptrdiff_t k = 0; k < prepared.padded; ++k) {
    const auto at = static_cast<std::size_t>(k);
    vector.charge[k] = static_cast<float>(root) * prepared.equilibrium[at];
    vector.moments[k] = static_cast<float>(1 / root) * prepared.potential[at];
  }
  vector.net = root * prepared.root;
}

/// Applies the off-diagonal blocks: evaluates the potentials of all vectors on the first `active` bodies, as
/// far as they are not known.
void ReducedSystem::apply_off_diagonal_blocks(std::size_t active) {
  float* const zero = slot();
  std::fill(zero, zero + slot_size_, 0.0F);
  std::vector<std::size_t> of_a, of_b;
  for (std::size_t a = 0; a < active; ++a)
    for (std::size_t b = a + 1; b < active; ++b) {
      of_a.clear();
      of_b.clear();
      for (std::size_t k = 0; k < used_; ++k) {
        if (vectors_[k].body == a && vectors_[k].potentials[b] == nullptr)
          of_a.push_back(k);
        if (vectors_[k].body == b && vectors_[k].potentials[a] == nullptr)
          of_b.push_back(k);
      }
      for (std::size_t k = 0; k < std::max(of_a.size(), of_b.size()); ++k) {
        check_interruption();
        float *on_a = slot(), *on_b = slot();
        pair(a, b).potentials(k < of_a.size() ? vectors_[of_a[k]].charge : zero,
                              k < of_b.size() ? vectors_[of_b[k]].charge : zero, on_a, on_b);
        if (k < of_a.size())
          vectors_[of_a[k]].potentials[b] = on_b;
        if (k < of_b.size())
          vectors_[of_b[k]].potentials[a] = on_a;
      }
    }
}

/// Appends rows to the Cholesky factor for the vectors that it does not contain yet.
void ReducedSystem::append_factor_rows() {
  const auto& kernels = best_kernels<NodeKernels>();
  if (net_.rows() < index_of(used_))
    net_.conservativeResize(2 * index_of(used_), index_of(conductors_));
  for (; extended_ < used_; ++extended_) {
    const Vector& vector = vectors_[extended_];
    const std::size_t start = factor_.size();
    factor_.resize(start + extended_ + 1);
    gram_.resize(start + extended_ + 1, 1);
    double* const row = factor_.data() + start;
    double square = 1;
    for (std::size_t k = 0; k < extended_; ++k) {
      const Vector& other = vectors_[k];
      double value = other.body == vector.body ? 0
                                               : kernels.dot(vector.charge, other.potentials[vector.body],
                                                             level(vector.body).padded);
      gram_[start + k] = value;
      const double* const other_row = factor_.data() + k * (k + 1) / 2;
      for (std::size_t l = 0; l < k; ++l)
        value -= row[l] * other_row[l];
      row[k] = value / other_row[k];
      square -= row[k] * row[k];
    }
    if (!(square > dependent * dependent)) {
      positive_definite_ = false;
      return;
    }
    row[extended_] = std::sqrt(square);
    const auto at = index_of(extended_);
    for (std::size_t c = 0; c < conductors_; ++c) {
      double value = bodies_[vector.body].conductor == c ? vector.net : 0;
      for (std::size_t k = 0; k < extended_; ++k)
        value -= row[k] * net_(index_of(k), index_of(c));
      net_(at, index_of(c)) = value / row[extended_];
    }
  }
}

/// Computes the coefficients of the vectors by back substitution.
void ReducedSystem::substitute_back(std::size_t conductors) {
  if (charges_.rows() < index_of(used_))
    charges_.resize(2 * index_of(used_), index_of(conductors_));
  for (std::size_t c = 0; c < conductors; ++c)
    for (std::size_t k = extended_; k-- > 0;) {
      double value = net_(index_of(k), index_of(c));
      for (std::size_t l = k + 1; l < extended_; ++l)
        value -= factor_[l * (l + 1) / 2 + k] * charges_(index_of(l), index_of(c));
      charges_(index_of(k), index_of(c)) = value / factor_[k * (k + 1) / 2 + k];
    }
}

/// Computes the residuals of charges, given by their coefficients, on each body, and the charges with which
/// the body alone responds to them.
void ReducedSystem::compute_residuals(std::size_t active, std::size_t conductors, const MatrixXd& charges,
                                      Residuals& residuals) {
  const auto& kernels = best_kernels<NodeKernels>();
  for (std::size_t body = 0; body < active; ++body) {
    const PreparedLevel& prepared = level(body);
    const auto scale = static_cast<float>(bodies_[body].scale);
    const float* const first = residuals.moments[body * conductors_];
    for (std::size_t c = 0; c < conductors; ++c) {
      float* const residual = residuals.moments[body * conductors_ + c];
      float* const correction = residuals.corrections[body * conductors_ + c];
      if (bodies_[body].conductor == c)
        std::copy_n(prepared.net.begin(), prepared.padded, residual);
      else
        std::fill_n(residual, prepared.padded, 0.0F);
      for (std::size_t k = 0; k < extended_; ++k) {
        const Vector& vector = vectors_[k];
        const auto coefficient = static_cast<float>(charges(index_of(k), index_of(c)));
        if (coefficient != 0)
          kernels.add(-coefficient, vector.body == body ? vector.moments : vector.potentials[body], residual,
                      prepared.padded);
      }
      const double multiple = c == 0 ? 0 : parallel(first, residual, prepared.padded);
      if (multiple != 0) {
        std::fill_n(correction, prepared.padded, 0.0F);
        kernels.add(static_cast<float>(multiple), residuals.corrections[body * conductors_], correction,
                    prepared.padded);
      } else if (kernels.dot(residual, residual, prepared.padded) == 0) {
        std::fill_n(correction, prepared.padded, 0.0F);
      } else {
        kernels.multiply(prepared.inverse.data(), prepared.count, residual, correction);
        for (std::ptrdiff_t k = 0; k < prepared.padded; ++k)
          correction[k] *= scale;
      }
    }
  }
}

/// Computes what the corrections of the last residuals add to the capacitances (`truncation`).
void ReducedSystem::sum_truncation(std::size_t active, std::size_t conductors) {
  const auto& kernels = best_kernels<NodeKernels>();
  solution_.truncation.setZero(index_of(conductors_), index_of(conductors_));
  for (std::size_t body = 0; body < active; ++body)
    for (std::size_t c = 0; c < conductors; ++c)
      for (std::size_t d = 0; d <= c; ++d)
        add(solution_.truncation, c, d,
            kernels.dot(residuals_.moments[body * conductors_ + d],
                        residuals_.corrections[body * conductors_ + c], level(body).padded));
}

/// Orthonormalises the corrections and adds them to the basis. Returns false if none of them is new.
bool ReducedSystem::append_residuals(std::size_t active, std::size_t conductors) {
  const auto& kernels = best_kernels<NodeKernels>();
  bool added = false;
  for (std::size_t body = 0; body < active; ++body) {
    const std::ptrdiff_t padded = level(body).padded;
    for (std::size_t c = 0; c < conductors; ++c) {
      float* const charge = residuals_.corrections[body * conductors_ + c];
      float* const moments = residuals_.moments[body * conductors_ + c];
      const double before = kernels.dot(charge, moments, padded);
      const double self = net_.col(index_of(c)).head(index_of(extended_)).squaredNorm();
      if (!(before > nothing * self))
        continue;
      orthogonalise(body, charge, moments);
      const double left = kernels.dot(charge, moments, padded);
      if (!(left > dependent * before))
        continue;
      const auto factor = static_cast<float>(1 / std::sqrt(left));
      for (std::ptrdiff_t k = 0; k < padded; ++k) {
        charge[k] *= factor;
        moments[k] *= factor;
      }
      // The second pass removes the rounding errors that the first one leaves in a small vector.
      orthogonalise(body, charge, moments);
      Vector& vector = new_vector(body);
      std::copy_n(charge, padded, vector.charge);
      std::copy_n(moments, padded, vector.moments);
      vector.net = kernels.dot(vector.charge, level(body).net.data(), padded);
      added = true;
    }
  }
  return added;
}

/// Extends the reduced basis by the residuals until the truncation is small enough, no residual is new, or
/// `most_steps` steps are taken.
void ReducedSystem::extend_basis(const ReductionLimits& limits, std::size_t active, std::size_t conductors) {
  for (int steps = 0;; ++steps) {
    apply_off_diagonal_blocks(active);
    append_factor_rows();
    if (!positive_definite_)
      return;
    if (steps == 0)
      estimate_truncation_left();
    substitute_back(conductors);
    compute_residuals(active, conductors, charges_, residuals_);
    sum_truncation(active, conductors);
    if (steps >= limits.most_steps)
      return;
    const auto size = index_of(conductors);
    const auto reached = net_.topLeftCorner(index_of(extended_), size);
    const bool enough =
        steps >= limits.least_steps &&
        (solution_.truncation_left * solution_.truncation.topLeftCorner(size, size).array().abs() <=
         limits.accuracy * (reached.transpose() * reached).array().abs())
            .all();
    if (enough || !append_residuals(active, conductors))
      return;
  }
}

/// Returns the interaction of the first vectors of two bodies, which have unit energy: 1 if the bodies
/// coincide.
double ReducedSystem::coupling(std::size_t first, std::size_t second) const {
  const std::size_t body = vectors_[first].body;
  return std::abs(best_kernels<NodeKernels>().dot(vectors_[first].charge, vectors_[second].potentials[body],
                                                  level(body).padded));
}

/// Estimates the fraction of the truncation that is still missing. Charges that answer the residuals on each
/// body alone cause new residuals through the bodies' coupling r: the fraction r/(1 − r). As the charges
/// oscillate, r is far below the coupling of the charges at equilibrium. Between squares at a fiftieth to a
/// twenty-fifth of their side, half of `per_coupling` was measured.
void ReducedSystem::estimate_truncation_left() {
  constexpr double least = 0.3;
  constexpr double per_coupling = 0.04;
  double strongest = 0;
  for (const std::size_t first : equilibria_)
    for (const std::size_t second : equilibria_)
      if (vectors_[first].body != vectors_[second].body)
        strongest = std::max(strongest, coupling(first, second));
  solution_.truncation_left = std::max(least, per_coupling / (1 - std::min(strongest, 1 - dependent)));
}

/// Returns the contribution of the highest functions of the first bodies to the capacitances, and stores that
/// of each body.
MatrixXd ReducedSystem::discretisation(std::size_t active, std::size_t conductors) {
  const auto size = index_of(conductors);
  MatrixXd result = MatrixXd::Zero(size, size);
  const Eigen::VectorXd own = net_.topLeftCorner(index_of(extended_), size).colwise().squaredNorm();
  solution_.body_discretisation.setZero(index_of(bodies_.size()));
  for (std::size_t body = 0; body < active; ++body) {
    const MatrixXd energies = highest_energies(body, charges_.leftCols(size));
    result += energies;
    for (Index c = 0; c < size; ++c)
      if (own[c] > 0)
        solution_.body_discretisation[index_of(body)] =
            std::max(solution_.body_discretisation[index_of(body)], energies(c, c) / own[c]);
  }
  return result;
}

/// Returns the change of the first bodies' capacitances from coarser triangles to the present ones.
MatrixXd ReducedSystem::missing(std::size_t active, std::size_t conductors) {
  const auto size = index_of(conductors);
  MatrixXd result = MatrixXd::Zero(size, size);
  for (std::size_t body = 0; body < active; ++body)
    result += form_of_charges(body, level(body).missing, nullptr, charges_.leftCols(size));
  return result;
}

/// Estimates the effect of the quadrature errors: each pair's relative error times the interaction of its
/// bodies. This interaction is at most the geometric mean of their energies, times the coupling of their
/// first vectors.
void ReducedSystem::estimate_quadrature() {
  const auto size = index_of(bodies_.size());
  solution_.pair_errors.setZero(size, size);
  solution_.couplings.setZero(size, size);
  for (std::size_t a = 0; a < bodies_.size(); ++a)
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (a != b) {
        double& interaction = solution_.couplings(index_of(a), index_of(b));
        interaction = coupling(equilibria_[a], equilibria_[b]);
        solution_.pair_errors(index_of(a), index_of(b)) =
            pair(std::min(a, b), std::max(a, b)).relative_error() * interaction;
      }
  MatrixXd roots = MatrixXd::Zero(size, index_of(conductors_));
  for (std::size_t k = 0; k < extended_; ++k)
    roots.row(index_of(vectors_[k].body)) += charges_.row(index_of(k)).cwiseAbs2();
  roots = roots.cwiseSqrt();
  solution_.quadrature = roots.transpose() * solution_.pair_errors * roots;
}

MatrixXd ReducedSystem::surface_charges() {
  const auto& kernels = best_kernels<NodeKernels>();
  std::vector<Eigen::RowVectorXd> rows;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const PreparedLevel& prepared = level(body);
    const std::span<const std::vector<float>> nets =
        prepared.surface_nets.empty() ? std::span(&prepared.net, 1) : std::span(prepared.surface_nets);
    for (const std::vector<float>& net : nets) {
      Eigen::RowVectorXd& row = rows.emplace_back(index_of(conductors_));
      for (std::size_t c = 0; c < conductors_; ++c)
        row[index_of(c)] =
            kernels.dot(residuals_.corrections[body * conductors_ + c], net.data(), prepared.padded);
      for (std::size_t k = 0; k < extended_; ++k)
        if (vectors_[k].body == body)
          row += kernels.dot(vectors_[k].charge, net.data(), prepared.padded) *
                 charges_.row(index_of(k)).head(index_of(conductors_));
    }
  }
  MatrixXd result(index_of(rows.size()), index_of(conductors_));
  for (std::size_t k = 0; k < rows.size(); ++k)
    result.row(index_of(k)) = rows[k];
  return result;
}

/// Solves for the machine alone, beginning with the sensors. Returns false if its matrix is not positive
/// definite.
bool ReducedSystem::solve_machine(const ReductionLimits& limits) {
  begin();
  machine_.reset();
  MachineBasis machine;
  for (std::size_t body = 0; body < sensor_bodies_; ++body)
    add_equilibrium(body);
  if (sensor_bodies_ > 0)
    extend_basis(limits, sensor_bodies_, sensors_);
  if (!positive_definite_)
    return false;
  machine.alone = extended_;
  if (sensor_bodies_ > 0) {
    machine.truncation_alone = solution_.truncation.diagonal().head(index_of(sensors_));
    machine.coarser_alone = missing(sensor_bodies_, sensors_).diagonal();
    machine.discretisation_alone =
        discretisation(sensor_bodies_, sensors_).diagonal() + machine.coarser_alone;
  }
  const std::size_t bodies = machine_bodies_.value_or(sensor_bodies_);
  if (bodies > sensor_bodies_ && bodies < bodies_.size()) {
    for (std::size_t body = sensor_bodies_; body < bodies; ++body)
      add_equilibrium(body);
    extend_basis(limits, bodies, conductors_);
    if (!positive_definite_)
      return false;
  }
  for (std::size_t body = 0; body < equilibria_.size(); ++body)
    machine.levels.push_back(bodies_[body].level);
  machine.least_steps = limits.least_steps;
  machine.vectors = extended_;
  machine.slots = slots_used_;
  machine_ = std::move(machine);
  return true;
}

const ReducedSolution& ReducedSystem::solve(const ReductionLimits& limits) {
  const auto sensors = index_of(sensors_);
  if (fit_slots() && knows_machine(limits))
    return_to_machine();
  else
    solve_machine(limits);
  if (positive_definite_) {
    for (std::size_t body = equilibria_.size(); body < bodies_.size(); ++body)
      add_equilibrium(body);
    extend_basis(limits, bodies_.size(), conductors_);
  }
  solution_.positive_definite = positive_definite_;
  if (!positive_definite_)
    return solution_;
  const auto reached = net_.topRows(index_of(extended_));
  solution_.values.noalias() = reached.transpose() * reached;
  solution_.values += solution_.truncation;
  solution_.discretisation = discretisation(bodies_.size(), conductors_);
  solution_.coarser = missing(bodies_.size(), conductors_);
  solution_.values += likely_missing * solution_.coarser;
  solution_.discretisation += solution_.coarser;
  if (sensor_bodies_ > 0) {
    const Eigen::VectorXd truncation = solution_.truncation.diagonal().head(sensors);
    solution_.delta_self =
        reached.bottomRows(index_of(extended_ - machine_->alone)).leftCols(sensors).colwise().squaredNorm();
    solution_.delta_self += truncation - machine_->truncation_alone;
    solution_.delta_self +=
        likely_missing * (solution_.coarser.diagonal().head(sensors) - machine_->coarser_alone);
    solution_.delta_truncation = truncation + machine_->truncation_alone;
    solution_.delta_discretisation =
        (solution_.discretisation.diagonal().head(sensors) - machine_->discretisation_alone).cwiseAbs();
  }
  solution_.facets = MatrixXd::Zero(index_of(conductors_), index_of(conductors_));
  for (std::size_t body = 0; body < bodies_.size(); ++body)
    solution_.facets +=
        form_of_charges(body, level(body).facets, nullptr, charges_.leftCols(index_of(conductors_)));
  estimate_quadrature();
  if (machine_bodies_)
    find_change();
  solution_.vectors = extended_;
  return solution_;
}

}  // namespace fringe::detail
