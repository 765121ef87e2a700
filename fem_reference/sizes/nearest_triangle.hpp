#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace sizes {

using Vector = std::array<double, 3>;
using Triangle = std::array<Vector, 3>;

/// Distances of points from the nearest of some triangles, by a tree of bounding boxes. Triangles with two
/// equal corners are segments.
class NearestTriangle {
 public:
  /// Builds the tree of the triangles given, of which there is at least one.
  explicit NearestTriangle(std::span<const Triangle> given);

  /// Returns the distance of `point` from the nearest triangle.
  double distance(const Vector& point) const;

 private:
  struct Box {
    Vector low, high;
  };
  struct Node {
    Box box;
    /// The triangles from `first` to `last`, of which a leaf has few; the first child follows its parent, and
    /// leaves have no second one.
    std::size_t first, last, second_child;
  };

  std::size_t build(std::size_t first, std::size_t last);
  void search(std::size_t node, const Vector& point, double& nearest_square) const;

  std::vector<Triangle> triangles;
  std::vector<Node> nodes;
};

}  // namespace sizes
