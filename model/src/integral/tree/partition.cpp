#include "integral/tree/partition.hpp"

#include <cstdint>

#include "geometry/median_split.hpp"

namespace fringe::detail {
namespace {

struct Centroid {
  Eigen::Vector3d position;
  std::uint32_t triangle;
};

}  // namespace

Partition partition(std::span<const Triangle> triangles) {
  Partition tree;
  std::vector<Centroid> centroids;
  centroids.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (twice_area(triangles[i]) > 0)
      centroids.push_back(
          {triangles[i][0] / 3 + triangles[i][1] / 3 + triangles[i][2] / 3, static_cast<std::uint32_t>(i)});
  if (centroids.empty())
    return tree;
  tree.nodes.push_back({.triangles = {0, centroids.size()}});
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const Range range = tree.nodes[i].triangles;
    if (range.count <= most_triangles_in_leaf)
      continue;
    const std::size_t half = range.count / 2;
    split_at_median(
        std::span(centroids).subspan(range.first, range.count), half,
        [](const Centroid& centroid) -> const Eigen::Vector3d& { return centroid.position; },
        [](const Centroid& centroid) { return centroid.triangle; });
    tree.nodes[i].first_child = tree.nodes.size();
    tree.nodes.push_back({.triangles = {range.first, half}});
    tree.nodes.push_back({.triangles = {range.first + half, range.count - half}});
  }
  tree.triangles.reserve(centroids.size());
  for (const Centroid& centroid : centroids)
    tree.triangles.push_back(triangles[centroid.triangle]);
  return tree;
}

}  // namespace fringe::detail
