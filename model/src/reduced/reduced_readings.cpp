#include "reduced/reduced_readings.hpp"

#include <algorithm>
#include <span>

#include <Eigen/Cholesky>

#include "bem/panel_mesh.hpp"
#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The charges of all readings (columns), those of what they sense and then those of what they drive, by
/// their coefficients as in ReducedChange.
struct ChargesOfReadings {
  MatrixXd background;  ///< without the targets
  MatrixXd change;      ///< what the targets change in these
};

/// The roots of energies (rows) of the same charges.
struct Roots {
  MatrixXd background, change, value;
};

Roots roots(const ChargesOfReadings& charges, std::span<const MatrixXd> energies) {
  const auto all = [&](const MatrixXd& of) {
    MatrixXd result(index_of(energies.size()), of.cols());
    for (std::size_t k = 0; k < energies.size(); ++k)
      result.row(index_of(k)) = of.cwiseProduct(energies[k] * of).colwise().sum().cwiseMax(0).cwiseSqrt();
    return result;
  };
  return {all(charges.background), all(charges.change), all(charges.background + charges.change)};
}

Roots roots(const ChargesOfReadings& charges, const MatrixXd& energy) {
  return roots(charges, std::span(&energy, 1));
}

/// Returns for every reading the sums of the products of roots for what it senses and drives, those of the
/// first ones (rows) and of the second ones (columns) with weights. The form of the change is that of the
/// value without that of the background, whose common part cancels.
ReadingEffects products(const Roots& roots, const MatrixXd& weights = MatrixXd::Ones(1, 1)) {
  const Index readings = roots.value.cols() / 2;
  const auto sums = [&](const MatrixXd& sense, const MatrixXd& drive) -> VectorXd {
    return sense.leftCols(readings).cwiseProduct(weights * drive.rightCols(readings)).colwise().sum();
  };
  return {sums(roots.value, roots.value), sums(roots.background, roots.background),
          sums(roots.background, roots.change) + sums(roots.change, roots.background) +
              sums(roots.change, roots.change)};
}

/// Adds errors that are at least the same parts of quantities as of the energies of both charges.
void add_errors(ReadingEffects& errors, double factor, const ReadingEffects& effects, const VectorXd& parts,
                const ReadingEffects& quantities) {
  const auto larger = [&](const VectorXd& effect, const VectorXd& quantity) -> VectorXd {
    return factor * effect.cwiseMax(parts.cwiseProduct(quantity.cwiseAbs()));
  };
  errors += {larger(effects.value, quantities.value), larger(effects.background, quantities.background),
             larger(effects.change, quantities.change)};
}

/// Returns the energies that targets gain by what is wrong with the potentials there, which are given as
/// roots of energies of the bodies (rows), to be multiplied by the couplings. They bound the errors of
/// changes by a target on which the machine's potentials cancel.
VectorXd energies_on_targets(std::size_t machine_bodies, const MatrixXd& couplings, const MatrixXd& roots) {
  const MatrixXd on_targets = couplings.bottomRows(couplings.rows() - index_of(machine_bodies)) * roots;
  const Index readings = roots.cols() / 2;
  return on_targets.leftCols(readings).cwiseProduct(on_targets.rightCols(readings)).colwise().sum();
}

}  // namespace

ReducedReadings reduced_readings(const std::vector<ChargedReading>& readings, const ReducedSolution& solution,
                                 double per_discretisation, const ChargedBodies& bodies) {
  const ReducedChange& found = *solution.change;
  const MatrixXd all = found.background + found.change;
  const MatrixXd without = potentials(found.background, bodies);
  const Index kept = without.cols(), rows = all.rows(), floating = rows - kept,
              number = index_of(readings.size());
  // The charges that the targets would put onto floating conductors, which take potentials that prevent it.
  MatrixXd with = MatrixXd::Zero(rows, kept);
  const MatrixXd insulated = floating_block(all, bodies);
  if (floating > 0)
    with.bottomRows(floating) = -insulated.llt().solve((found.change * without).bottomRows(floating));

  MatrixXd driven(kept, 2 * number);
  for (Index k = 0; k < number; ++k) {
    driven.col(k) = readings[static_cast<std::size_t>(k)].sense.head(kept);
    driven.col(number + k) = readings[static_cast<std::size_t>(k)].drive.head(kept);
  }
  // The potentials of all conductors without the targets, and what the targets change in them.
  const MatrixXd before = without * driven, added = with * driven;
  ChargesOfReadings charges{MatrixXd::Zero(2 * rows, 2 * number), MatrixXd(2 * rows, 2 * number)};
  charges.background.topRows(rows) = before;
  charges.change << added, before + added;
  const auto sums = [&](const MatrixXd& sense, const MatrixXd& drive) -> VectorXd {
    return sense.leftCols(number).cwiseProduct(drive.rightCols(number)).colwise().sum();
  };
  ReadingEffects quantities;
  quantities.background = sums(driven, (found.background * before).topRows(kept));
  quantities.change = sums(before, found.change * before);
  if (floating > 0)
    quantities.change -= sums(added.bottomRows(floating), insulated * added.bottomRows(floating));
  quantities.value = quantities.background + quantities.change;
  VectorXd scales(number);
  for (Index k = 0; k < number; ++k)
    scales[k] = change_scale(quantities.value[k], quantities.change[k]);
  const auto largest = [&](const VectorXd& errors) {
    return number > 0 ? std::max(errors.cwiseQuotient(scales).maxCoeff(), 0.0) : 0;
  };
  const MatrixXd whole = before + added;
  const VectorXd energies = whole.cwiseProduct(all * whole).colwise().sum();
  const Eigen::ArrayXd squares = energies.head(number).array() * energies.tail(number).array();
  // Returns parts of the energies of both charges.
  const auto parts = [&](const ReadingEffects& effects) -> VectorXd {
    return (squares > 0).select(effects.value.array() / squares.sqrt(), 0);
  };

  ReducedReadings result;
  result.charges.resize(2 * rows, 4 * number);
  result.charges << charges.background.leftCols(number), charges.change.leftCols(number),
      charges.background.rightCols(number), charges.change.rightCols(number);
  result.facets = products(roots(charges, found.facets));
  const VectorXd none = VectorXd::Zero(number);
  ReadingEffects errors{none, none, none}, resolved = errors;
  const ReadingEffects truncated = products(roots(charges, found.truncation));
  add_errors(errors, solution.truncation_left, truncated, parts(truncated), quantities);
  result.truncation = largest(errors.change);

  const Roots of_bodies = roots(charges, found.energies);
  MatrixXd missing = MatrixXd::Zero(of_bodies.value.rows(), 2 * number),
           discretisation = MatrixXd::Zero(2 * rows, 2 * rows);
  result.body_discretisation.setZero(missing.rows());
  for (Index body = 0; body < missing.rows(); ++body) {
    const MatrixXd& of_body = found.discretisation[static_cast<std::size_t>(body)];
    const Roots missed = roots(charges, of_body);
    const ReadingEffects effects = products(missed);
    result.body_discretisation[body] = largest(effects.change);
    resolved += effects;
    discretisation += of_body;
    missing.row(body) = missed.value;
  }
  // A Galerkin solution misses of every smooth functional, such as the potentials on other bodies, what it
  // misses of the energy: here the root of a body's energy times the missing part of that energy.
  missing = (of_bodies.value.array() > 0).select(missing.array().square() / of_bodies.value.array(), 0);
  resolved.change += energies_on_targets(found.machine_bodies, solution.couplings, missing);
  add_errors(errors, per_discretisation, resolved, parts(products(roots(charges, discretisation))),
             quantities);
  ReadingEffects integrated = products(of_bodies, solution.pair_errors);
  integrated.change += energies_on_targets(found.machine_bodies, solution.pair_errors, of_bodies.value);
  add_errors(errors, 1, integrated, none, quantities);
  result.error = largest(errors.change);
  result.quadrature = largest(integrated.change);
  for (Index k = 0; k < number; ++k)
    result.answers.push_back({readings[static_cast<std::size_t>(k)].name,
                              {quantities.value[k], errors.value[k]},
                              {quantities.background[k], errors.background[k]},
                              {quantities.change[k], errors.change[k]}});
  return result;
}

}  // namespace fringe::detail
