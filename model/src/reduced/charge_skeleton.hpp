#pragma once

#include <array>
#include <span>
#include <vector>

#include "bem/bodies.hpp"
#include "reduced/panel_clusters.hpp"

/// Few point charges in the place of a body's panels (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// Distances from a body's panels, in its unit, for which there are skeletons.
constexpr std::array<double, 6> skeleton_distances{0.26, 0.36, 0.5, 0.75, 1.1, 1.8};

/// Charges in points of a body's surface, one cluster, whose potentials beyond a distance are those of all
/// panels' charges.
struct ChargeSkeleton {
  double distance;           ///< from the panels, in the body's unit
  std::ptrdiff_t functions;  ///< number of the first functions whose charges it has
  ChargedPanels nodes;
  double error;  ///< of the potentials there and beyond, relative to those of charges of unit energy
};

/// Finds the skeletons of a body of several functions for one of `skeleton_distances`, those of fewest nodes
/// first; none if too many nodes would be needed.
std::vector<ChargeSkeleton> charge_skeletons(const ChargedPanels& body, std::ptrdiff_t functions,
                                             std::span<const TriangleSurface> surfaces, double distance);

}  // namespace fringe::detail
