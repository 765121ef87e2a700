/// The energies of charges in a ReducedSystem, and what targets change.

#include <algorithm>
#include <numeric>

#include <Eigen/Cholesky>

#include "bem/panel_mesh.hpp"
#include "reduced/reduced_system.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

/// Adds the charges on a body that combinations (columns) of the vectors make, each in a column of so many
/// numbers.
void ReducedSystem::add_charges(std::size_t body, const MatrixXd& combinations, float* to,
                                std::ptrdiff_t stride) const {
  const auto& kernels = best_kernels<NodeKernels>();
  for (Index c = 0; c < combinations.cols(); ++c)
    for (std::size_t k = 0; k < extended_; ++k)
      if (vectors_[k].body == body)
        kernels.add(static_cast<float>(combinations(static_cast<Index>(k), c)), vectors_[k].charge,
                    to + c * stride, level(body).padded);
}

/// Returns a form of a body's charges, which are given by their coefficients (columns), such as what the body
/// alone gains by its highest functions, or the energies that coarser triangles would miss; zero if the form
/// is empty. `functions` are those that the form has, in ascending order; null: all.
MatrixXd ReducedSystem::form_of_charges(std::size_t body, const std::vector<float>& form,
                                        const std::vector<int>* functions, const MatrixXd& charges) {
  const auto& kernels = best_kernels<NodeKernels>();
  const std::ptrdiff_t padded = level(body).padded;
  MatrixXd result = MatrixXd::Zero(charges.cols(), charges.cols());
  if (form.empty())
    return result;
  const std::ptrdiff_t count = functions != nullptr ? index_of(functions->size()) : level(body).count;
  work_.assign(static_cast<std::size_t>(charges.cols() * padded), 0.0F);
  stiff_.resize(static_cast<std::size_t>(padded));
  add_charges(body, charges, work_.data(), padded);
  for (Index c = 0; c < charges.cols(); ++c) {
    float* const charge = work_.data() + c * padded;
    if (functions != nullptr) {
      for (std::size_t k = 0; k < functions->size(); ++k)
        charge[k] = charge[(*functions)[k]];
      std::fill(charge + count, charge + padded, 0.0F);
    }
    kernels.multiply(form.data(), count, charge, stiff_.data());
    for (Index d = 0; d <= c; ++d)
      result(c, d) = result(d, c) =
          kernels.dot(work_.data() + d * padded, stiff_.data(), whole_blocks(count)) / bodies_[body].scale;
  }
  return result;
}

/// Returns what the highest functions of a body alone gain.
MatrixXd ReducedSystem::highest_energies(std::size_t body, const MatrixXd& charges) {
  return form_of_charges(body, level(body).stiffness, &level(body).highest, charges);
}

/// Returns what the residuals add to the capacitances: their products with their corrections, those of the
/// background's charges first, then those of what the targets change in these.
MatrixXd ReducedSystem::residual_energies() {
  const auto& kernels = best_kernels<NodeKernels>();
  const auto count = static_cast<Index>(conductors_);
  MatrixXd sum = MatrixXd::Zero(2 * count, 2 * count);
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const std::size_t first = body * conductors_;
    for (const Residuals* const row : {&background_residuals_, &residuals_})
      for (const Residuals* const column : {&background_residuals_, &residuals_})
        for (Index c = 0; c < count; ++c)
          for (Index d = 0; d < count; ++d)
            sum(c + (row == &residuals_ ? count : 0), d + (column == &residuals_ ? count : 0)) +=
                kernels.dot(row->moments[first + static_cast<std::size_t>(c)],
                            column->corrections[first + static_cast<std::size_t>(d)], level(body).padded);
  }
  // The second half becomes the difference of the charges with the targets and without them.
  sum.bottomRows(count) -= sum.topRows(count).eval();
  sum.rightCols(count) -= sum.leftCols(count).eval();
  return (sum + sum.transpose()) / 2;
}

/// Finds what the targets change, by factorising the vectors of the machine first. The background is then the
/// best charge in the span of these, and each row of the targets' vectors adds its square: value and
/// background share all that the basis lacks, and nothing is a difference of almost equal numbers.
void ReducedSystem::find_change() {
  const auto size = static_cast<Index>(extended_), count = static_cast<Index>(conductors_);
  std::vector<std::size_t> order(extended_);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto targets = std::stable_partition(
      order.begin(), order.end(), [&](std::size_t k) { return vectors_[k].body < *machine_bodies_; });
  const auto machine = static_cast<Index>(targets - order.begin());
  MatrixXd products(size, size), nets = MatrixXd::Zero(size, count);
  for (Index row = 0; row < size; ++row) {
    const std::size_t k = order[static_cast<std::size_t>(row)];
    if (const std::size_t conductor = bodies_[vectors_[k].body].conductor; conductor < conductors_)
      nets(row, static_cast<Index>(conductor)) = vectors_[k].net;
    for (Index column = 0; column <= row; ++column) {
      const auto [l, m] = std::minmax(k, order[static_cast<std::size_t>(column)]);
      products(row, column) = gram_[m * (m + 1) / 2 + l];
    }
  }
  const Eigen::LLT<MatrixXd> factor(products);
  const MatrixXd rows = factor.matrixL().solve(nets);
  MatrixXd charges = MatrixXd::Zero(size, 2 * count);
  const MatrixXd background = factor.matrixLLT()
                                  .topLeftCorner(machine, machine)
                                  .triangularView<Eigen::Lower>()
                                  .transpose()
                                  .solve(rows.topRows(machine));
  for (Index row = 0; row < machine; ++row)
    charges.row(static_cast<Index>(order[static_cast<std::size_t>(row)])).head(count) = background.row(row);
  compute_residuals(*machine_bodies_, conductors_, charges.leftCols(count), background_residuals_);
  charges.rightCols(count) = charges_.topLeftCorner(size, count) - charges.leftCols(count);

  ReducedChange& result = solution_.change.emplace();
  result.machine_bodies = *machine_bodies_;
  result.truncation = residual_energies();
  result.facets = MatrixXd::Zero(2 * count, 2 * count);
  MatrixXd added = result.truncation;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const MatrixXd triangles = form_of_charges(body, level(body).missing, nullptr, charges);
    result.facets += form_of_charges(body, level(body).facets, nullptr, charges);
    added += likely_missing * triangles;
    result.discretisation.emplace_back(highest_energies(body, charges) + triangles);
    std::vector<Index> own;
    for (std::size_t k = 0; k < extended_; ++k)
      if (vectors_[k].body == body)
        own.push_back(static_cast<Index>(k));
    const MatrixXd coefficients = charges(own, Eigen::all);
    result.energies.emplace_back(coefficients.transpose() * coefficients);
  }
  const auto without = rows.topRows(machine), with = rows.bottomRows(size - machine);
  const auto mixed = added.topRightCorner(count, count);
  result.background = without.transpose() * without + added.topLeftCorner(count, count);
  result.change = with.transpose() * with + mixed + mixed.transpose() + added.bottomRightCorner(count, count);
  charges_in_change_ = charges;
}

Eigen::MatrixXf ReducedSystem::charges_in_change(std::size_t body, const MatrixXd& combination) {
  const auto& kernels = best_kernels<NodeKernels>();
  const std::ptrdiff_t padded = level(body).padded;
  const auto count = static_cast<Index>(conductors_);
  Eigen::MatrixXf result = Eigen::MatrixXf::Zero(padded + node_block, combination.cols());
  add_charges(body, charges_in_change_ * combination, result.data(), result.rows());
  for (Index column = 0; column < combination.cols(); ++column) {
    float* const charge = result.col(column).data();
    for (Index c = 0; c < count; ++c) {
      const std::size_t at = body * conductors_ + static_cast<std::size_t>(c);
      const double change = combination(count + c, column), background = combination(c, column) - change;
      kernels.add(static_cast<float>(change), residuals_.corrections[at], charge, padded);
      kernels.add(static_cast<float>(background), background_residuals_.corrections[at], charge, padded);
    }
  }
  return result;
}

}  // namespace fringe::detail
