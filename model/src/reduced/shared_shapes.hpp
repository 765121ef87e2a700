#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "reduced/prepared_shape.hpp"

namespace fringe::detail {

/// Shapes by their proportions: those that are alike are prepared once.
class SharedShapes {
 public:
  /// A plate or a box, whose largest half side is 1.
  PreparedShape* find(std::size_t faces, const Eigen::Vector3d& half_sides);

  /// A body of triangles, as PreparedMesh has them.
  PreparedShape* find(const std::vector<Triangle>& triangles, double accuracy);

 private:
  std::vector<std::unique_ptr<PreparedShape>> shapes_;
};

}  // namespace fringe::detail
