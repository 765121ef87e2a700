#include "reduced/panel_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "fringe/bounding_volume.hpp"
#include "geometry/box_tree.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Largest number of panels in a cluster, a multiple of a block.
constexpr std::size_t panels_per_cluster = 2 * static_cast<std::size_t>(node_block);

/// Halves the range across its longest direction, again and again, until each part is one cluster.
void divide(std::span<const Panel> panels, std::span<std::size_t> range,
            std::vector<std::span<std::size_t>>& clusters) {
  if (range.size() <= panels_per_cluster) {
    clusters.push_back(range);
    return;
  }
  // Only the last cluster is not full.
  const std::size_t whole = (range.size() + panels_per_cluster - 1) / panels_per_cluster;
  const std::size_t half = whole / 2 * panels_per_cluster;
  split_at_median(range, half, [&](std::size_t panel) -> const Vector3d& { return panels[panel].centre; });
  divide(panels, range.first(half), clusters);
  divide(panels, range.subspan(half), clusters);
}

void add_points(std::span<const Panel> panels, const PanelCluster& cluster, PanelClusters& result) {
  for (int fineness = 0; fineness <= PanelClusters::finest; ++fineness) {
    std::vector<std::vector<Vector3d>> centres(static_cast<std::size_t>(cluster.count));
    for (std::size_t k = 0; k < centres.size(); ++k)
      add_centres_of_parts(panels[result.panels[static_cast<std::size_t>(cluster.first) + k]].corners,
                           fineness, centres[k]);
    for (std::size_t part = 0; part < centres[0].size(); ++part)
      for (const std::vector<Vector3d>& of_panel : centres)
        for (std::size_t axis = 0; axis < 3; ++axis)
          result.points[static_cast<std::size_t>(fineness)][axis].push_back(
              static_cast<float>(of_panel[part][static_cast<Eigen::Index>(axis)]));
  }
}

}  // namespace

NodePoints MeshPart::points(const PanelClusters& panels) const {
  const auto& of_fineness = panels.points[static_cast<std::size_t>(fineness)];
  const std::ptrdiff_t at = repeats() * cluster->first;
  return {of_fineness[0].data() + at, of_fineness[1].data() + at, of_fineness[2].data() + at, count()};
}

BoxNumbers box_around(const std::vector<Vector3d>& points) {
  const OrientedBox box = oriented_box(points, {}, BoxMethod::vertices);
  return box_along(box.axes.transpose(), box.centre, box.half_widths);
}

BoxNumbers box_along(const Eigen::Matrix3d& axes, const Vector3d& centre, const Vector3d& half_widths) {
  BoxNumbers result{};
  for (Eigen::Index row = 0; row < 3; ++row) {
    result.centre[row] = centre[row];
    result.half_widths[row] = half_widths[row];
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      result.axes[3 * row + axis] = axes(row, axis);
  }
  return result;
}

PanelClusters cluster_panels(std::span<const Panel> panels) {
  std::vector<std::size_t> order(panels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::span<std::size_t>> ranges;
  divide(panels, order, ranges);

  PanelClusters result;
  for (const std::span<std::size_t> range : ranges) {
    PanelCluster cluster{static_cast<std::ptrdiff_t>(result.panels.size()),
                         whole_blocks(static_cast<std::ptrdiff_t>(range.size())),
                         Vector3d::Zero(),
                         0,
                         0,
                         {}};
    std::vector<Vector3d> corners;
    Eigen::AlignedBox3d box;
    for (std::size_t k = 0; k < static_cast<std::size_t>(cluster.count); ++k) {
      const Panel& panel = panels[range[std::min(k, range.size() - 1)]];
      result.panels.push_back(range[std::min(k, range.size() - 1)]);
      result.is_repeated.push_back(k >= range.size());
      corners.insert(corners.end(), panel.corners.begin(), panel.corners.end());
      cluster.panel_radius = std::max(cluster.panel_radius, panel.radius);
    }
    for (const Vector3d& corner : corners)
      box.extend(corner);
    cluster.centre = box.center();
    for (const Vector3d& corner : corners)
      cluster.radius = std::max(cluster.radius, (corner - cluster.centre).norm());
    cluster.box = box_around(corners);
    add_points(panels, cluster, result);
    result.clusters.push_back(cluster);
  }
  return result;
}

}  // namespace fringe::detail
