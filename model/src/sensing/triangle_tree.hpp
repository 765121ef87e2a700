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
  /// Builds the hierarchy. Throws InputError for a vertex that is not finite.
  explicit TriangleTree(std::span<const Triangle> triangles);

  /// Offers to the query the triangles, moved by the pose, that could be its answer, each with its index.
  void search(ConeQuery& query, const Eigen::Isometry3d& pose, std::size_t surface) const;

 private:
  BoxTree tree_;
  std::vector<Triangle> triangles_;  ///< in the order of tree_.items(), those of a leaf adjacent
};

}  // namespace fringe::detail
