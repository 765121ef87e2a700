/// The energies of charges in a ReducedSystem, and what targets change.

#include <algorithm>
#include <numeric>

#include <Eigen/Cholesky>

#include "reduced/reduced_system.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

/// Returns the energies of the highest functions of a body in charges, which are given by their coefficients
/// (columns): what the body alone gains by these functions.
MatrixXd ReducedSystem::highest_energies(std::size_t body, const MatrixXd& charges) {
  const auto& kernels = best_kernels<NodeKernels>();
  const PreparedLevel& prepared = level(body);
  const auto count = static_cast<std::ptrdiff_t>(prepared.highest.size());
  const std::ptrdiff_t padded = whole_blocks(count);
  work_.assign(static_cast<std::size_t>(charges.cols() * padded), 0.0F);
  stiff_.resize(static_cast<std::size_t>(padded));
  MatrixXd energies(charges.cols(), charges.cols());
  for (Index c = 0; c < charges.cols(); ++c) {
    float* const high = work_.data() + c * padded;
    for (std::size_t k = 0; k < extended_; ++k) {
      if (vectors_[k].body != body)
        continue;
      const auto factor = static_cast<float>(charges(static_cast<Index>(k), c));
      for (std::size_t h = 0; h < prepared.highest.size(); ++h)
        high[h] += factor * vectors_[k].charge[prepared.highest[h]];
    }
    kernels.multiply(prepared.stiffness.data(), count, high, stiff_.data());
    for (Index d = 0; d <= c; ++d)
      energies(c, d) = energies(d, c) =
          kernels.dot(work_.data() + d * padded, stiff_.data(), padded) / bodies_[body].scale;
  }
  return energies;
}

/// Returns a form of the charges of a body of triangles, such as the energies that coarser ones would miss,
/// as highest_energies() does; zero if the form is empty.
MatrixXd ReducedSystem::triangle_energies(std::size_t body, const std::vector<float>& form,
                                          const MatrixXd& charges) {
  const auto& kernels = best_kernels<NodeKernels>();
  const PreparedLevel& prepared = level(body);
  MatrixXd energies = MatrixXd::Zero(charges.cols(), charges.cols());
  if (form.empty())
    return energies;
  work_.assign(static_cast<std::size_t>(charges.cols() * prepared.padded), 0.0F);
  stiff_.resize(static_cast<std::size_t>(prepared.padded));
  for (Index c = 0; c < charges.cols(); ++c) {
    float* const charge = work_.data() + c * prepared.padded;
    for (std::size_t k = 0; k < extended_; ++k)
      if (vectors_[k].body == body)
        kernels.add(static_cast<float>(charges(static_cast<Index>(k), c)), vectors_[k].charge, charge,
                    prepared.padded);
    kernels.multiply(form.data(), prepared.count, charge, stiff_.data());
    for (Index d = 0; d <= c; ++d)
      energies(c, d) = energies(d, c) =
          kernels.dot(work_.data() + d * prepared.padded, stiff_.data(), prepared.padded) /
          bodies_[body].scale;
  }
  return energies;
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
    const MatrixXd triangles = triangle_energies(body, level(body).missing, charges);
    result.facets += triangle_energies(body, level(body).facets, charges);
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
  const MatrixXd coefficients = charges_in_change_ * combination;
  for (Index column = 0; column < combination.cols(); ++column) {
    float* const charge = result.col(column).data();
    for (std::size_t k = 0; k < extended_; ++k)
      if (vectors_[k].body == body)
        kernels.add(static_cast<float>(coefficients(static_cast<Index>(k), column)), vectors_[k].charge,
                    charge, padded);
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
