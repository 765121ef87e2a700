#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

namespace fringe::detail {

/// The groups of panels that hold the most of what one density on each misses, as many as it takes to come
/// below the allowed energy, or to have the greater part of it, and no more than make `most` panels more.
/// Groups that hold the same are taken together. Empty if none is to be refined.
std::vector<bool> groups_to_refine(const std::vector<PanelGroup>& groups, const Eigen::VectorXd& energies,
                                   double allowed, std::size_t most);

}  // namespace fringe::detail
