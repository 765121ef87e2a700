#pragma once

#include <Eigen/Core>

namespace fringe {

/// A flat rectangular sensor plate: the points corner + a·edge_u + b·edge_v with a and b in [0, 1], in
/// metres.
struct Rectangle {
  Eigen::Vector3d corner;
  Eigen::Vector3d edge_u;
  Eigen::Vector3d edge_v;
};

/// Throws InputError unless the rectangle is valid: finite, no edge of length zero, and |edge_u·edge_v| ≤
/// 1e-9·|edge_u|·|edge_v|.
void validate(const Rectangle& rectangle);

}  // namespace fringe
