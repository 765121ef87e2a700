#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fringe/triangle.hpp"

namespace fringe {

/// Triangles laid out for integrating many at a time: prepared once, used with any number of plates.
class TriangleBatch {
 public:
  /// @throws InputError when a vertex is not finite; the message names the triangle by its index.
  explicit TriangleBatch(std::span<const Triangle> triangles);

  std::size_t size() const { return size_; }
  Triangle operator[](std::size_t index) const;

  /// Returns one coordinate of all triangles: 0 to 8 for v0.x, v0.y, v0.z, v1.x, … v2.z. Readable up to the
  /// next multiple of 8 triangles; those beyond size() have no area.
  const double* coordinate(std::size_t which) const { return numbers_.data() + which * stride_; }

  /// Returns twice the area of all triangles (m²), laid out like a coordinate.
  const double* twice_area() const { return numbers_.data() + 9 * stride_; }

  /// Returns the largest squared distance of a vertex from the centroid (m²), laid out like a coordinate.
  const double* squared_size() const { return numbers_.data() + 10 * stride_; }

 private:
  std::size_t size_;
  std::size_t stride_;
  std::vector<double> numbers_;
};

}  // namespace fringe
