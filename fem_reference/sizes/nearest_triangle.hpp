#pragma once

#include <array>
#include <compare>
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
  /// Builds the tree of the triangles given, of which there is at least one. An offset belongs to each.
  NearestTriangle(std::span<const Triangle> given, std::span<const double> offsets);

  /// Returns the least sum of the distance of `point` from a triangle and the triangle's offset.
  double distance(const Vector& point) const;

 private:
  struct Box {
    Vector low, high;
  };
  struct Placed {
    Triangle triangle;
    double offset;
    auto operator<=>(const Placed&) const = default;
  };
  struct Node {
    Box box;
    double least_offset;
    /// The triangles from `first` to `last`, of which a leaf has few; the first child follows its parent, and
    /// leaves have no second one.
    std::size_t first, last, second_child;
  };

  std::size_t build(std::size_t first, std::size_t last);
  void search(std::size_t node, const Vector& point, double& nearest) const;

  std::vector<Placed> triangles;
  std::vector<Node> nodes;
};

}  // namespace sizes
