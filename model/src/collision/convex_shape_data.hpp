#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "fringe/convex_shape.hpp"
#include "quick_search.hpp"

namespace fringe::detail {

/// Coordinates as a structure of arrays, padded as VertexArrays asks for.
struct CoordinateLists {
  std::vector<double> x, y, z;

  void push_back(const Eigen::Vector3d& point);

  /// Repeats the last point up to the next multiple of the padding.
  void pad();

  VertexArrays arrays() const { return {x.data(), y.data(), z.data(), static_cast<std::uint32_t>(x.size())}; }
};

/// What a DirectionCells points to.
struct CellLists {
  int resolution = 0;
  std::vector<std::uint32_t> starts;
  CoordinateLists coordinates;
  std::vector<std::uint32_t> indices;
};

/// The cells of a hull; none where looking at all vertices is as fast.
CellLists direction_cells(std::span<const Eigen::Vector3d> vertices, double reach);

struct ConvexShapeData {
  SupportShape support;
  std::vector<Eigen::Vector3d> vertices;  ///< of flat shapes; a box's in the order of SupportPair
  CoordinateLists coordinates;
  CellLists cells;
};

}  // namespace fringe::detail
