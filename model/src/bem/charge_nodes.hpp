#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_system.hpp"
#include "surface/bodies.hpp"

/// Charges of rigid bodies as point charges, dense enough for the forces between bodies on different links
/// (model/BOUNDARY_ELEMENTS.md, section 12).
namespace fringe::detail {

/// The charges of all bodies on one link, or of those on none.
struct LinkCharges {
  std::optional<std::size_t> link;
  Eigen::Matrix3Xd points;
  Eigen::MatrixXd charges;  ///< of every point (rows), in the columns of ReadingCharges::all()
};

/// The charges of all links that have any.
struct ChargeNodes {
  std::vector<LinkCharges> links;
  /// Pairs of `links` that are too close to each other: their nodes are too few.
  std::vector<std::pair<std::size_t, std::size_t>> too_close;
};

/// Places nodes on all faces and panels, the denser the closer a body of another link is, and gives each its
/// share of the charges. The relative error of forces is about 1e-4.
ChargeNodes charge_nodes(const PanelSystem& system, const PanelSolution& solution,
                         const ChargedBodies& bodies);

}  // namespace fringe::detail
