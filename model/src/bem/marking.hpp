#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

namespace fringe::detail {

/// Returns the number of steps in which to refine each group of panels, as PanelMesh::refine takes them;
/// empty if nothing is to be refined. Marks the groups with the largest error indicators (Dörfler marking):
/// as many as it takes to bring the missing energy below `allowed`, and no more than add `most` panels. So
/// that few refinements suffice, marks more until these add four tenths of the panels, but none of negligible
/// indicator. Marks groups with equal indicators together. With one step for each group, it also stops when
/// the marked ones have the greater part of the energy; with more, up to `most_steps`, a group is marked
/// again if what each of its triangles is expected to miss then is still among the largest.
std::vector<int> mark_for_refinement(const std::vector<PanelGroup>& groups, const Eigen::VectorXd& energies,
                                     double allowed, std::size_t most, int most_steps = 1);

}  // namespace fringe::detail
