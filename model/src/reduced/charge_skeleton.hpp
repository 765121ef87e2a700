#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "reduced/panel_clusters.hpp"
#include "surface/bodies.hpp"

/// Few point charges in the place of a body's panels (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// Distances from a body's panels, in its unit, for which there are skeletons.
constexpr std::array<double, 15> skeleton_distances{0.015, 0.022, 0.032, 0.047, 0.068, 0.1, 0.14, 0.195,
                                                    0.25,  0.32,  0.42,  0.55,  0.75,  1.1, 1.8};

/// Errors of the potentials that skeletons may have.
constexpr std::array<double, 10> skeleton_accuracies{4e-5, 1.5e-4, 6e-4, 1.2e-3, 2.5e-3,
                                                     5e-3, 1e-2,   2e-2, 4e-2,   8e-2};

/// Charges in points of a body's surface, one cluster, whose potentials beyond a distance are those of all
/// panels' charges.
struct ChargeSkeleton {
  ChargedPanels nodes;
  double error;  ///< of the potentials there and beyond, relative to those of charges of unit energy
  double ratio;  ///< largest radius of the parts of panels that points stood for, over the distance
};

/// Finds few charges in the place of those of a body's first functions for points that are at least
/// `distance` away, in its unit, to an accuracy; none if too many would be needed.
std::optional<ChargeSkeleton> charge_skeleton(const ChargedPanels& body, std::ptrdiff_t functions,
                                              std::span<const TriangleSurface> surfaces, double distance,
                                              double accuracy);

}  // namespace fringe::detail
