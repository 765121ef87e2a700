#include "bem/error_indicators.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "bem/single_layer_panels.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Returns the round shape that the panels of a group follow; null: none.
const RoundShape* followed_by(const PanelGroup& group, const ChargedBodies& bodies) {
  const RoundShape* const round = round_shape_of(bodies.bodies[group.body].surface);
  return round != nullptr && round->is_followed() ? round : nullptr;
}

/// Returns the error by a panel's facet, per product of two of its charges.
double facet_error(const RoundShape& round, const Panel& panel, const RowVectorXd& charges) {
  return round.error_per_lack() *
         (round.lack_per_squared_charge(panel) + round.lack_along_rim(panel, charges.cwiseAbs().maxCoeff()));
}

}  // namespace

SampledQuarters sampled_quarters(const PanelMesh& mesh) {
  /// Largest sample; it is enough to estimate the mean energy.
  constexpr std::size_t most_samples = 96;
  std::vector<std::size_t> unrefined, bodies;
  for (const PanelGroup& group : mesh.groups())
    for (std::size_t k = 0; k < group.count && !group.is_quartered; ++k) {
      unrefined.push_back(group.first + k);
      bodies.push_back(group.body);
    }
  SampledQuarters sampled;
  if (unrefined.empty())
    return sampled;
  const std::size_t count = unrefined.size(), samples = std::min(most_samples, count);
  for (std::size_t k = 0; k < samples; ++k) {
    // Equal steps would meet the same triangle of every segment of a round shape.
    constexpr double golden = std::numbers::phi - 1;
    const double part = static_cast<double>(k) * golden;
    const std::size_t at =
        samples == count
            ? k
            : std::min(static_cast<std::size_t>((part - std::floor(part)) * static_cast<double>(count)),
                       count - 1);
    for (const Triangle& quarter : quarters(mesh.panels()[unrefined[at]].corners)) {
      sampled.panels.push_back(make_panel(quarter));
      sampled.bodies.push_back(bodies[at]);
      sampled.parents.push_back(unrefined[at]);
    }
  }
  sampled.weight = static_cast<double>(unrefined.size()) / static_cast<double>(samples);
  return sampled;
}

MatrixXd energy_of_quarters(const SampledQuarters& quarters, const MatrixXd& missing_potentials,
                            double tolerance) {
  MatrixXd gained = MatrixXd::Zero(missing_potentials.cols(), missing_potentials.cols());
  const std::span<const Panel> panels = quarters.panels;
  for (std::size_t k = 0; k < panels.size(); k += 4) {
    const MatrixXd own = single_layer_matrix(panels.subspan(k, 4), tolerance).selfadjointView<Eigen::Upper>();
    const MatrixXd here = missing_potentials.middleRows(index_of(k), 4);
    const Eigen::LLT<MatrixXd> factor(own);
    const MatrixXd answer = factor.solve(here);
    const VectorXd net = factor.solve(VectorXd::Ones(4));
    gained += here.transpose() * (answer - net * (answer.colwise().sum() / net.sum()));
  }
  return gained * quarters.weight;
}

MatrixXd detail_energies(const PanelMesh& mesh, const std::vector<MatrixXd>& blocks, const VectorXd& shares,
                         const MatrixXd& charges) {
  MatrixXd energies(index_of(mesh.groups().size()), charges.cols());
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const auto first = index_of(mesh.groups()[g].first), count = index_of(mesh.groups()[g].count);
    for (Index c = 0; c < charges.cols(); ++c) {
      VectorXd details = charges.col(c).segment(first, count);
      details -= details.sum() * shares.segment(first, count);
      energies(index_of(g), c) = std::max(details.dot(blocks[g] * details), 0.0);
    }
  }
  return energies;
}

MatrixXd energies_of_pairs(const MatrixXd& energies) {
  MatrixXd pairs = MatrixXd::Zero(energies.cols(), energies.cols());
  for (Index row = 0; row < energies.rows(); ++row) {
    const RowVectorXd roots = energies.row(row).cwiseSqrt();
    pairs += roots.transpose() * roots;
  }
  return pairs;
}

VectorXd largest_parts(const MatrixXd& energies, const VectorXd& own) {
  VectorXd result = VectorXd::Zero(energies.rows());
  for (Index c = 0; c < energies.cols(); ++c)
    if (own[c] > 0)
      result = result.cwiseMax(energies.col(c) / own[c]);
  return result;
}

VectorXd largest_parts_of_change(const MatrixXd& energies, const VectorXd& scales) {
  VectorXd result(energies.rows());
  for (Index row = 0; row < energies.rows(); ++row)
    result[row] = largest_part_of_change(energies.row(row).cwiseSqrt(), scales);
  return result;
}

MatrixXd facet_energies(const PanelMesh& mesh, const ChargedBodies& bodies, const MatrixXd& charges) {
  MatrixXd energies = MatrixXd::Zero(index_of(mesh.groups().size()), charges.cols());
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    const RoundShape* const round = followed_by(group, bodies);
    for (std::size_t k = group.first; round != nullptr && k < group.first + group.count; ++k) {
      const RowVectorXd own = charges.row(index_of(k));
      energies.row(index_of(g)) += facet_error(*round, mesh.panels()[k], own) * own.cwiseAbs2();
    }
  }
  return energies;
}

VectorXd facet_indicators(const PanelMesh& mesh, const ChargedBodies& bodies, const MatrixXd& charges,
                          const Eigen::ArrayXXd& scales) {
  VectorXd result = VectorXd::Zero(index_of(mesh.groups().size()));
  for (std::size_t g = 0; g < mesh.groups().size() && charges.cols() > 0; ++g) {
    const PanelGroup& group = mesh.groups()[g];
    const RoundShape* const round = followed_by(group, bodies);
    if (round == nullptr)
      continue;
    MatrixXd errors = MatrixXd::Zero(charges.cols(), charges.cols());
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      const RowVectorXd own = charges.row(index_of(k)).cwiseAbs();
      errors += facet_error(*round, mesh.panels()[k], own) * own.transpose() * own;
    }
    result[index_of(g)] = (errors.array() / scales).maxCoeff();
  }
  return result;
}

VectorXd unrefined_indicators(const PanelMesh& mesh, const std::vector<MatrixXd>& blocks,
                              const MatrixXd& charges, const VectorXd& own, double part) {
  VectorXd result = VectorXd::Zero(index_of(mesh.groups().size()));
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    for (std::size_t k = group.first; k < group.first + group.count && !group.is_quartered; ++k)
      result[index_of(g)] +=
          (charges.row(index_of(k)).cwiseAbs2().array() / own.transpose().array()).maxCoeff() *
          blocks[g](index_of(k - group.first), index_of(k - group.first));
  }
  return result * (part / result.sum());
}

}  // namespace fringe::detail
