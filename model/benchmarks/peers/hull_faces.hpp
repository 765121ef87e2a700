#pragma once

#include <vector>

#include <Eigen/Core>

namespace fringe::benchmarks {

/// The surface of a convex hull.
struct HullFaces {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<int>> faces;  ///< indices of vertices, anticlockwise from outside
};

/// By Bullet's hull computer; FCL asks for the faces of a convex shape and has no means to find them.
HullFaces hull_faces(const std::vector<Eigen::Vector3d>& points);

}  // namespace fringe::benchmarks
