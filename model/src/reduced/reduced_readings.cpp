#include "reduced/reduced_readings.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The potentials of all conductors that belong to those of the driven ones.
struct PotentialsOfReading {
  VectorXd background;  ///< without the targets
  VectorXd change;      ///< what the targets change: the potentials of floating conductors

  /// Returns the coefficients of the background's charges and of their changes in the charge without the
  /// targets.
  VectorXd charge() const { return joined(background, VectorXd::Zero(background.size())); }
  /// Returns those in what the targets change in the charge.
  VectorXd charge_change() const { return joined(change, background + change); }

 private:
  static VectorXd joined(const VectorXd& first, const VectorXd& second) {
    VectorXd result(first.size() + second.size());
    result << first, second;
    return result;
  }
};

/// The roots of energies of the charges of a reading, for s and d each.
struct Roots {
  double background;
  double change;
  double value;
};

Roots roots(const PotentialsOfReading& potentials, const MatrixXd& energies) {
  const VectorXd background = potentials.charge(), change = potentials.charge_change();
  const auto root = [&](const VectorXd& charge) {
    return std::sqrt(std::max(charge.dot(energies * charge), 0.0));
  };
  return {root(background), root(change), root(background + change)};
}

/// Bounds of a symmetric form of charges for a reading's value, background and change.
struct Effects {
  double value = 0;
  double background = 0;
  double change = 0;
};

/// Adds a multiple of the products of roots. The form of the change is that of the value without that of the
/// background, whose common part cancels.
void add_products(Effects& effects, double factor, const Roots& sense, const Roots& drive) {
  effects.value += factor * sense.value * drive.value;
  effects.background += factor * sense.background * drive.background;
  effects.change += factor * (sense.background * drive.change + sense.change * drive.background +
                              sense.change * drive.change);
}

/// Adds an error that is at least the same part of a quantity as of the energies of both charges.
void add_error(Effects& errors, double factor, const Effects& effects, double part,
               const Effects& quantities) {
  errors.value += factor * std::max(effects.value, part * std::abs(quantities.value));
  errors.background += factor * std::max(effects.background, part * std::abs(quantities.background));
  errors.change += factor * std::max(effects.change, part * std::abs(quantities.change));
}

/// Adds the effect of the pairs' quadrature errors, by the roots of the energies of the bodies' charges.
void add_quadrature(Effects& effects, const MatrixXd& pair_errors, const std::vector<Roots>& sense,
                    const std::vector<Roots>& drive) {
  for (std::size_t a = 0; a < sense.size(); ++a)
    for (std::size_t b = 0; b < sense.size(); ++b)
      add_products(effects, pair_errors(static_cast<Index>(a), static_cast<Index>(b)), sense[a], drive[b]);
}

/// Returns the energy that targets gain by what is wrong with the potentials there, which `sense` and `drive`
/// give as roots of energies of the bodies, to be multiplied by the couplings. It bounds the error of a
/// change by a target on which the machine's potentials cancel.
double energy_on_targets(std::size_t machine_bodies, const MatrixXd& couplings, const VectorXd& sense,
                         const VectorXd& drive) {
  const auto targets = couplings.bottomRows(couplings.rows() - static_cast<Index>(machine_bodies));
  return (targets * sense).dot(targets * drive);
}

/// Returns the roots of the bodies' energies.
VectorXd values(const std::vector<Roots>& roots) {
  VectorXd result(static_cast<Index>(roots.size()));
  for (Index k = 0; k < result.size(); ++k)
    result[k] = roots[static_cast<std::size_t>(k)].value;
  return result;
}

/// Returns what functions are missing for the potentials on other bodies: the root of a body's energy times
/// the part of the energy that is missing, as of all smooth functionals of a Galerkin solution.
VectorXd missing_potentials(const std::vector<Roots>& missing, const std::vector<Roots>& energies) {
  const Eigen::ArrayXd roots = values(energies).array();
  return (roots > 0).select(values(missing).array().square() / roots, 0);
}

}  // namespace

ReducedReadings reduced_readings(const std::vector<ChargedReading>& readings, const ReducedSolution& solution,
                                 double per_discretisation, const ChargedBodies& bodies) {
  const ReducedChange& found = *solution.change;
  const MatrixXd all = found.background + found.change;
  const MatrixXd without = potentials(found.background, bodies);
  const Index kept = without.cols(), floating = all.rows() - kept;
  // The charges that the targets would put onto floating conductors, which take potentials that prevent it.
  MatrixXd with = MatrixXd::Zero(all.rows(), kept);
  const MatrixXd insulated = floating_block(all, bodies);
  if (floating > 0)
    with.bottomRows(floating) = -insulated.llt().solve((found.change * without).bottomRows(floating));
  const std::size_t count = found.energies.size();
  MatrixXd discretisation = MatrixXd::Zero(found.truncation.rows(), found.truncation.cols());
  for (const MatrixXd& energies : found.discretisation)
    discretisation += energies;

  const auto number = static_cast<Index>(readings.size());
  ReducedReadings result{{}, VectorXd::Zero(static_cast<Index>(count)), 0, 0, 0, {}, {}};
  result.charges.resize(found.truncation.rows(), 4 * number);
  result.facets = {VectorXd(number), VectorXd(number), VectorXd(number)};
  for (Index k = 0; k < number; ++k) {
    const ChargedReading& reading = readings[static_cast<std::size_t>(k)];
    const VectorXd sensed = reading.sense.head(kept), driven = reading.drive.head(kept);
    const PotentialsOfReading sense{without * sensed, with * sensed}, drive{without * driven, with * driven};
    result.charges.col(k) = sense.charge();
    result.charges.col(number + k) = sense.charge_change();
    result.charges.col(2 * number + k) = drive.charge();
    result.charges.col(3 * number + k) = drive.charge_change();
    Effects quantities;
    quantities.background = sensed.dot((found.background * drive.background).head(kept));
    quantities.change = sense.background.dot(found.change * drive.background);
    if (floating > 0)
      quantities.change -= sense.change.tail(floating).dot(insulated * drive.change.tail(floating));
    quantities.value = quantities.background + quantities.change;

    const auto energy = [&](const PotentialsOfReading& potentials) {
      const VectorXd whole = potentials.background + potentials.change;
      return whole.dot(all * whole);
    };
    const double product = energy(sense) * energy(drive);
    const auto part = [&](const Roots& one, const Roots& other) {
      return product > 0 ? one.value * other.value / std::sqrt(product) : 0;
    };
    Effects errors, truncated, resolved, integrated, facets;
    add_products(facets, 1, roots(sense, found.facets), roots(drive, found.facets));
    result.facets.value[k] = facets.value;
    result.facets.background[k] = facets.background;
    result.facets.change[k] = facets.change;
    const Roots sense_truncation = roots(sense, found.truncation);
    const Roots drive_truncation = roots(drive, found.truncation);
    add_products(truncated, 1, sense_truncation, drive_truncation);
    add_error(errors, solution.truncation_left, truncated, part(sense_truncation, drive_truncation),
              quantities);
    const double scale = change_scale(quantities.value, quantities.change);
    result.truncation = std::max(result.truncation, errors.change / scale);

    std::vector<Roots> sense_energies, drive_energies, sense_missing, drive_missing;
    for (std::size_t body = 0; body < count; ++body) {
      Effects of_body;
      sense_missing.push_back(roots(sense, found.discretisation[body]));
      drive_missing.push_back(roots(drive, found.discretisation[body]));
      add_products(of_body, 1, sense_missing.back(), drive_missing.back());
      resolved.value += of_body.value;
      resolved.background += of_body.background;
      resolved.change += of_body.change;
      double& largest = result.body_discretisation[static_cast<Index>(body)];
      largest = std::max(largest, of_body.change / scale);
      sense_energies.push_back(roots(sense, found.energies[body]));
      drive_energies.push_back(roots(drive, found.energies[body]));
    }
    resolved.change += energy_on_targets(found.machine_bodies, solution.couplings,
                                         missing_potentials(sense_missing, sense_energies),
                                         missing_potentials(drive_missing, drive_energies));
    add_error(errors, per_discretisation, resolved,
              part(roots(sense, discretisation), roots(drive, discretisation)), quantities);
    add_quadrature(integrated, solution.pair_errors, sense_energies, drive_energies);
    integrated.change += energy_on_targets(found.machine_bodies, solution.pair_errors, values(sense_energies),
                                           values(drive_energies));
    add_error(errors, 1, integrated, 0, quantities);
    result.error = std::max(result.error, errors.change / scale);
    result.quadrature = std::max(result.quadrature, integrated.change / scale);
    result.answers.push_back({reading.name,
                              {quantities.value, errors.value},
                              {quantities.background, errors.background},
                              {quantities.change, errors.change}});
  }
  return result;
}

}  // namespace fringe::detail
