#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/triangle.hpp"
#include "sensing/cone_query.hpp"

namespace fringe::detail {

/// Axis-aligned boxes around ever fewer triangles of a surface.
class TriangleTree {
 public:
  /// Throws InputError for a vertex that is not finite.
  explicit TriangleTree(std::span<const Triangle> triangles);

  /// Offers the triangles, moved by the pose, that could be the query's answer, by their indices.
  void search(ConeQuery& query, const Eigen::Isometry3d& pose, std::size_t surface) const;

 private:
  /// A leaf has triangles; another node has two children, the first of them right behind it.
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
    std::uint32_t second_child = 0;
  };

  void build(std::size_t first, std::size_t last, std::span<const Eigen::Vector3d> centres);

  std::vector<Triangle> triangles_;     ///< those of a leaf side by side
  std::vector<std::uint32_t> indices_;  ///< where each was given
  std::vector<Node> nodes_;
};

}  // namespace fringe::detail
