#include "bem/unrefined_elements.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "bem/panel_equations.hpp"
#include "bem/single_layer_panels.hpp"

namespace fringe::detail {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SampledQuarters sampled_quarters(const PanelMesh& mesh) {
  /// Largest sample; it is enough to estimate the mean energy.
  constexpr std::size_t most_samples = 96;
  std::vector<std::size_t> undivided;
  for (const PanelGroup& group : mesh.groups())
    for (std::size_t k = 0; k < group.count && !group.is_quartered; ++k)
      undivided.push_back(group.first + k);
  SampledQuarters sampled;
  if (undivided.empty())
    return sampled;
  const std::size_t samples = std::min(most_samples, undivided.size());
  for (std::size_t k = 0; k < samples; ++k)
    for (const Triangle& quarter : quarters(mesh.panels()[undivided[k * undivided.size() / samples]].corners))
      sampled.panels.push_back(make_panel(quarter));
  sampled.weight = static_cast<double>(undivided.size()) / static_cast<double>(samples);
  return sampled;
}

MatrixXd energy_of_quarters(const SampledQuarters& quarters, const MatrixXd& lacking, double tolerance) {
  MatrixXd gained = MatrixXd::Zero(lacking.cols(), lacking.cols());
  const std::span<const Panel> panels = quarters.panels;
  for (std::size_t k = 0; k < panels.size(); k += 4) {
    const MatrixXd own = panel_matrix(panels.subspan(k, 4), tolerance).selfadjointView<Eigen::Upper>();
    const MatrixXd here = lacking.middleRows(index_of(k), 4);
    const Eigen::LLT<MatrixXd> factor(own);
    const MatrixXd answer = factor.solve(here);
    const VectorXd net = factor.solve(VectorXd::Ones(4));
    gained += here.transpose() * (answer - net * (answer.colwise().sum() / net.sum()));
  }
  return gained * quarters.weight;
}

}  // namespace fringe::detail
