#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "collision/gjk_filter.hpp"
#include "reduced/node_kernels.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {

/// Panels that are near each other, in whole blocks of places; the last block may repeat a panel.
struct PanelCluster {
  std::ptrdiff_t first;  ///< the first place
  std::ptrdiff_t count;  ///< number of places
  Eigen::Vector3d centre;
  double radius;        ///< of a sphere about the centre that contains the panels
  double panel_radius;  ///< radius of the largest panel
  BoxNumbers box;       ///< around its panels
};

/// The places of a body's panels in clusters, and points on the panels.
struct PanelClusters {
  /// Largest number of times that panels are quartered for their points: 1, 4 or 16 on each.
  static constexpr int finest = 2;

  std::vector<PanelCluster> clusters;
  std::vector<std::size_t> panels;  ///< the panel at every place
  std::vector<bool> is_repeated;    ///< true for a place whose panel has another place, too
  /// For every fineness the points' x, y and z, cluster by cluster: the first points of all places of
  /// a cluster, then their second …
  std::array<std::array<std::vector<float>, 3>, finest + 1> points;
};

/// Points on the panels of a cluster, each of which is quartered `fineness` times.
struct MeshPart {
  const PanelCluster* cluster;
  int fineness;

  std::ptrdiff_t repeats() const { return std::ptrdiff_t{1} << (2 * fineness); }
  std::ptrdiff_t count() const { return repeats() * cluster->count; }
  NodePoints points(const PanelClusters& panels) const;
};

/// A body's charges on the places of its panels, one row for every function.
struct ChargedPanels {
  PanelClusters panels;
  std::vector<float> charges;

  std::ptrdiff_t places() const { return static_cast<std::ptrdiff_t>(panels.panels.size()); }

  /// Returns the charges of the first functions.
  NodeMatrix functions(std::ptrdiff_t count) const { return {charges.data(), count, places()}; }
};

/// Divides panels into clusters of nearby ones.
PanelClusters cluster_panels(std::span<const Panel> panels);

/// Returns a box around points, along the axes of their spread.
BoxNumbers box_around(const std::vector<Eigen::Vector3d>& points);

/// Returns a box along the columns of `axes`.
BoxNumbers box_along(const Eigen::Matrix3d& axes, const Eigen::Vector3d& centre,
                     const Eigen::Vector3d& half_widths);

}  // namespace fringe::detail
