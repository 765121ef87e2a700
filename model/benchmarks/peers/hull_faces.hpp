#pragma once

#include <vector>

#include <Eigen/Core>

namespace fringe::benchmarks {

/// The surface of a convex hull.
struct HullFaces {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<int>> faces;  ///< indices of vertices, anticlockwise from outside
};

/// Computes the hull by Bullet's hull computer; FCL needs the faces of a convex shape and cannot compute
/// them.
HullFaces hull_faces(const std::vector<Eigen::Vector3d>& points);

}  // namespace fringe::benchmarks
