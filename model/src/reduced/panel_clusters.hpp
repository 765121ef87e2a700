#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/panel.hpp"
#include "collision/gjk_filter.hpp"

namespace fringe::detail {

/// Panels that are near each other: whole blocks of places, of which the last may repeat a panel.
struct PanelCluster {
  std::ptrdiff_t first;  ///< place
  std::ptrdiff_t count;  ///< of places
  Eigen::Vector3d centre;
  double radius;        ///< no point of its panels is farther from the centre
  double panel_radius;  ///< of the largest of its panels
  BoxNumbers box;       ///< around its panels
};

/// The places of a body's panels, in clusters, and points on them.
struct PanelClusters {
  /// How often panels may be quartered for their points: 1, 4 or 16 on each.
  static constexpr int finest = 2;

  std::vector<PanelCluster> clusters;
  std::vector<std::size_t> panels;  ///< at every place
  std::vector<bool> is_repeated;    ///< places whose panel stands elsewhere
  /// For every fineness the points' x, y and z, cluster by cluster: the first points of all places of
  /// a cluster, then their second …
  std::array<std::array<std::vector<float>, 3>, finest + 1> points;
};

/// Clusters of about so many panels.
PanelClusters cluster_panels(std::span<const Panel> panels);

/// A box around points along the axes of their spread.
BoxNumbers box_around(const std::vector<Eigen::Vector3d>& points);

/// A box along the columns of `axes`.
BoxNumbers box_along(const Eigen::Matrix3d& axes, const Eigen::Vector3d& centre,
                     const Eigen::Vector3d& half_widths);

}  // namespace fringe::detail
