#include "bem/group_densities.hpp"

#include <vector>

#include "numeric/interruption.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd area_shares(const PanelMesh& mesh) {
  const std::vector<Panel>& panels = mesh.panels();
  VectorXd shares(index_of(panels.size()));
  for (const PanelGroup& group : mesh.groups()) {
    double area = 0;
    for (std::size_t k = 0; k < group.count; ++k)
      area += panels[group.first + k].area;
    for (std::size_t k = 0; k < group.count; ++k)
      shares[index_of(group.first + k)] = panels[group.first + k].area / area;
  }
  return shares;
}

MatrixXd group_means(const PanelMesh& mesh, const VectorXd& shares,
                     const Eigen::Ref<const MatrixXd>& values) {
  const std::vector<PanelGroup>& groups = mesh.groups();
  MatrixXd means(index_of(groups.size()), values.cols());
  for (Index c = 0; c < values.cols(); ++c)
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto first = index_of(groups[g].first), count = index_of(groups[g].count);
      means(index_of(g), c) = values.col(c).segment(first, count).dot(shares.segment(first, count));
    }
  return means;
}

std::vector<MatrixXd> group_blocks(const PanelMesh& mesh, const MatrixXd& panels) {
  std::vector<MatrixXd> blocks;
  for (const PanelGroup& group : mesh.groups()) {
    const auto first = index_of(group.first), count = index_of(group.count);
    blocks.emplace_back(panels.block(first, first, count, count).selfadjointView<Eigen::Upper>());
  }
  return blocks;
}

MatrixXd group_matrix(const PanelMesh& mesh, const VectorXd& shares, const MatrixXd& panels) {
  const std::vector<PanelGroup>& groups = mesh.groups();
  const std::vector<MatrixXd> blocks = group_blocks(mesh, panels);
  MatrixXd matrix(index_of(groups.size()), index_of(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    check_interruption();
    const auto first = index_of(groups[g].first), count = index_of(groups[g].count);
    const auto own_shares = shares.segment(first, count);
    // The earlier groups: whole columns above the diagonal.
    const VectorXd column = panels.middleCols(first, count).topRows(first) * own_shares;
    for (std::size_t h = 0; h < g; ++h)
      matrix(index_of(g), index_of(h)) =
          column.segment(index_of(groups[h].first), index_of(groups[h].count))
              .dot(shares.segment(index_of(groups[h].first), index_of(groups[h].count)));
    matrix(index_of(g), index_of(g)) = own_shares.dot(blocks[g] * own_shares);
  }
  return matrix;
}

}  // namespace fringe::detail
