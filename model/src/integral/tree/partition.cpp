#include "integral/tree/partition.hpp"

#include <algorithm>
#include <cstdint>

#include <Eigen/Geometry>

namespace fringe::detail {
namespace {

struct Centroid {
  Eigen::Vector3d position;
  std::uint32_t triangle;
};

void split_at_median(std::span<Centroid> centroids) {
  Eigen::AlignedBox3d box;
  for (const Centroid& centroid : centroids)
    box.extend(centroid.position);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto middle = centroids.begin() + static_cast<std::ptrdiff_t>(centroids.size() / 2);
  // Ties by the triangle's number: the order does not depend on how the library selects.
  std::nth_element(centroids.begin(), middle, centroids.end(), [axis](const Centroid& a, const Centroid& b) {
    return a.position[axis] < b.position[axis] ||
           (a.position[axis] == b.position[axis] && a.triangle < b.triangle);
  });
}

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
    split_at_median(std::span(centroids).subspan(range.first, range.count));
    const std::size_t half = range.count / 2;
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
