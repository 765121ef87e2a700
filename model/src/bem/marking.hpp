#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

namespace fringe::detail {

/// Marks the groups of panels with the largest error indicators (Dörfler marking): as many as it takes to
/// bring the missing energy below `allowed`, or to have the greater part of it, and no more than add `most`
/// panels. Marks groups with equal indicators together. Returns an empty vector if none is to be refined.
std::vector<bool> groups_to_refine(const std::vector<PanelGroup>& groups, const Eigen::VectorXd& energies,
                                   double allowed, std::size_t most);

}  // namespace fringe::detail
