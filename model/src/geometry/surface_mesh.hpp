#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// A triangle mesh as vertices and faces, with the adjacency of its faces. Corners of triangles are one
/// vertex when their coordinates are equal.
class SurfaceMesh {
 public:
  using Face = std::array<std::uint32_t, 3>;

  /// The side of one face or more.
  struct Edge {
    std::uint32_t from;  ///< the vertex that comes first in vertices()
    std::uint32_t to;
    std::span<const std::uint32_t> faces;  ///< in their order; a face with two sides on the edge twice
    int balance;  ///< how many faces run along it from `from` to `to`, less those that run back
  };

  /// Faces are numbered as the triangles.
  explicit SurfaceMesh(std::span<const Triangle> triangles);
  SurfaceMesh(const SurfaceMesh&) = delete;
  SurfaceMesh& operator=(const SurfaceMesh&) = delete;

  /// The vertices by x, then y, then z.
  std::span<const Eigen::Vector3d> vertices() const { return vertices_; }
  std::span<const Face> faces() const { return faces_; }
  /// The edges by their first vertex, then their second.
  std::span<const Edge> edges() const { return edges_; }

  /// Returns for each face those that share an edge with it, one entry for each edge that they share.
  std::vector<std::vector<std::uint32_t>> neighbours() const;

  /// Returns for each face the number of its shell, which is a part of the mesh that is connected through
  /// edges. Shells are numbered in the order of their first faces.
  std::vector<std::uint32_t> shells() const;

  /// Tells whether every edge is used as often in one direction as in the other.
  bool is_closed() const;

 private:
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> faces_of_edges_;
  std::vector<Edge> edges_;
};

/// Returns whether a closed surface encloses a point that is not on it, by the winding number.
bool is_in_polyhedron(std::span<const Triangle> surface, const Eigen::Vector3d& point);

}  // namespace fringe::detail
