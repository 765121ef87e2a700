#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "collision/gjk_filter.hpp"
#include "fringe/convex_shape.hpp"

namespace fringe::detail {

/// Vertex coordinates in the layout that VertexBlocks describes.
class CoordinateBlocks {
 public:
  void push_back(const Eigen::Vector3d& point);

  /// Repeats the last point until its block is full.
  void fill_block();

  std::size_t size() const { return size_; }
  /// Returns a view of the coordinates, valid until the next change.
  VertexBlocks blocks() const {
    return {coordinates_.data(), static_cast<std::uint32_t>(size_), static_cast<std::uint32_t>(last_)};
  }

 private:
  std::vector<double> coordinates_;
  std::size_t size_ = 0;
  std::size_t last_ = 0;
};

/// Storage of a DirectionCells.
struct CellLists {
  int resolution = 0;
  std::vector<std::uint32_t> starts;
  CoordinateBlocks coordinates;
  std::vector<std::uint32_t> indices;
};

/// Builds the direction cells of a hull; none if it has so few vertices that comparing all is as fast.
CellLists direction_cells(std::span<const Eigen::Vector3d> vertices, double bounding_radius);

struct ConvexShapeData {
  SupportShape support;
  std::vector<Eigen::Vector3d> vertices;  ///< of polytopes
  CoordinateBlocks coordinates;
  CellLists cells;
};

}  // namespace fringe::detail
