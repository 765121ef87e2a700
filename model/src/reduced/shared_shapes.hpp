#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "reduced/prepared_shape.hpp"

namespace fringe::detail {

/// Shapes by their proportions: bodies of the same proportions share one, which is prepared once.
class SharedShapes {
 public:
  /// Returns the shape of a plate or a box whose largest half side is 1.
  PreparedShape* find(std::size_t faces, const Eigen::Vector3d& half_sides);

  /// Returns the shape of a body of triangles, which are as in PreparedMesh.
  PreparedShape* find(const std::vector<Triangle>& triangles, double accuracy);

 private:
  std::vector<std::unique_ptr<PreparedShape>> shapes_;
};

}  // namespace fringe::detail
