#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/triangle.hpp"
#include "geometry/box_tree.hpp"
#include "sensing/cone_query.hpp"

namespace fringe::detail {

/// The triangles of a surface in a bounding volume hierarchy.
class TriangleTree {
 public:
  /// Throws InputError for a vertex that is not finite.
  explicit TriangleTree(std::span<const Triangle> triangles);

  /// Offers the triangles, moved by the pose, that could be the query's answer, by their indices.
  void search(ConeQuery& query, const Eigen::Isometry3d& pose, std::size_t surface) const;

 private:
  BoxTree tree_;
  std::vector<Triangle> triangles_;  ///< in the order of tree_.items(): those of a leaf side by side
};

}  // namespace fringe::detail
