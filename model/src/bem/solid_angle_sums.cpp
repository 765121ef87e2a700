#include "bem/solid_angle_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "bem/insulated_equations.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Largest error of a sum that quadratures may leave, over the largest jump of the permittivity. A larger one
/// belongs to a surface that is not closed.
constexpr double largest_error_of_sum = 0.1;

}  // namespace

std::vector<Index> components_of(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                 const InsulatedUnknowns& unknowns) {
  const std::vector<Insulator>& insulators = bodies.insulators;
  const std::size_t conductors = bodies.conductors.bodies.size();
  std::vector<Eigen::AlignedBox3d> boxes;
  std::vector<Index> component;
  for (const Insulator& insulator : insulators) {
    const Eigen::Vector3d margin =
        Eigen::Vector3d::Constant(2 * touching_surfaces * insulator.box.diagonal().norm());
    boxes.emplace_back(insulator.box.min() - margin, insulator.box.max() + margin);
    const Index own = index_of(component.size());
    component.push_back(own);
    for (std::size_t other = 0; other + 1 < boxes.size(); ++other)
      if (boxes[other].intersects(boxes.back()))
        std::replace(component.begin(), component.end(), Index{component[other]}, own);
  }
  std::vector<Index> result(unknowns.panels.size(), AngleSums::unknown);
  for (std::size_t k = 0; k < result.size(); ++k) {
    const Ratios& ratios = unknowns.states[k].ratios;
    if (ratios.behind == ratios.before)
      continue;
    const auto body = static_cast<std::size_t>(unknowns.body[k]);
    if (body >= conductors && body < conductors + insulators.size()) {
      result[k] = component[body - conductors];
      continue;
    }
    const Eigen::Vector3d& centre = mesh.panels()[static_cast<std::size_t>(unknowns.panels[k])].centre;
    const auto around =
        std::find_if(boxes.begin(), boxes.end(), [&](const auto& box) { return box.contains(centre); });
    if (around != boxes.end())
      result[k] = component[static_cast<std::size_t>(around - boxes.begin())];
  }
  return result;
}

AngleSums::AngleSums(const InsulatedUnknowns& unknowns, const std::vector<Index>& components,
                     const std::vector<AngleTarget>& targets, const Column& column)
    : components_(components) {
  Index count = 0;
  for (const Index component : components)
    count = std::max(count, component + 1);
  const Index size = index_of(targets.size());
  MatrixXd sums = MatrixXd::Zero(size, count), magnitudes = sums;
  std::vector<double> largest(static_cast<std::size_t>(count), 0.0);
  for (Index k = 0; k < unknowns.size(); ++k) {
    const Ratios& ratios = unknowns.states[static_cast<std::size_t>(k)].ratios;
    const double jump = ratios.behind - ratios.before;
    jumps_.push_back(jump);
    const Index component = components[static_cast<std::size_t>(k)];
    if (component == unknown)
      continue;
    double& most = largest[static_cast<std::size_t>(component)];
    most = std::max(most, std::abs(jump));
    const Eigen::VectorXd part = jump * column(k);
    sums.col(component) += part;
    magnitudes.col(component) += part.cwiseAbs();
  }
  factors_ = MatrixXd::Zero(size, count);
  for (Index row = 0; row < size && count > 0; ++row) {
    auto [mean, own] = targets[static_cast<std::size_t>(row)];
    // Inside of a dielectric the sum is that of a closed surface around it.
    if (own == unknown && mean != 1)
      sums.row(row).cwiseAbs().maxCoeff(&own);
    for (Index component = 0; component < count; ++component) {
      const double lack = (component == own ? mean - 1 : 0) - sums(row, component);
      if (magnitudes(row, component) > 0 &&
          std::abs(lack) <= largest_error_of_sum * largest[static_cast<std::size_t>(component)])
        factors_(row, component) = lack / magnitudes(row, component);
    }
  }
}

Eigen::VectorXd AngleSums::corrected(Index unknown, const Eigen::VectorXd& column) const {
  const auto at = static_cast<std::size_t>(unknown);
  Eigen::VectorXd result = jumps_[at] * column;
  if (const Index component = components_[at]; component != AngleSums::unknown)
    result += factors_.col(component).cwiseProduct(result.cwiseAbs());
  return result;
}

}  // namespace fringe::detail
