#pragma once

#include <cstdint>

#include "geometry/plate_frame.hpp"
#include "integral/batch/kernels.hpp"

namespace fringe::detail {

/// Pieces of triangles that several borders cross, gathered so that they are integrated a register at a time.
class PieceBuffer {
 public:
  /// Results are added to values[index].
  PieceBuffer(const BatchKernels& kernels, const Choices& choices, double* values);

  /// Cuts a triangle at the plate's borders.
  void add(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area, std::uint32_t index);

  /// Integrates what is waiting.
  void flush();

 private:
  static constexpr std::size_t capacity = 256;

  /// The kernel of a waiting piece, whatever its shape.
  double careful_kernel(std::size_t piece) const;

  /// The vector from the plate to a corner of a waiting piece.
  Eigen::Vector3d corner(std::size_t piece, std::size_t which) const;

  const BatchKernels& kernels_;
  const Choices& choices_;
  double* values_;
  std::size_t size_ = 0;
  double components_[9][capacity] = {};
  double shares_[capacity] = {};       // of the triangle's area
  double twice_areas_[capacity] = {};  // of the triangle
  double weights_[capacity] = {};      // the product of the two
  std::uint32_t indices_[capacity] = {};
};

}  // namespace fringe::detail
