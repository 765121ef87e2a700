#pragma once

#include <cstdint>

#include "geometry/plate_frame.hpp"
#include "integral/batch/kernels.hpp"

namespace fringe::detail {

/// Buffer for the pieces of triangles that several border planes cross; integrates them one register at a
/// time.
class PieceBuffer {
 public:
  /// Adds results to values[index].
  PieceBuffer(const BatchKernels& kernels, const Choices& choices, double* values);

  /// Cuts a triangle at the plate's border planes and stores the pieces.
  void add(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area, std::uint32_t index);

  /// Integrates the stored pieces.
  void flush();

 private:
  static constexpr std::size_t capacity = 256;

  /// Computes the kernel of a stored piece of any shape.
  double careful_kernel(std::size_t piece) const;

  /// Returns the vector from the plate to a corner of a stored piece.
  Eigen::Vector3d corner(std::size_t piece, std::size_t which) const;

  const BatchKernels& kernels_;
  const Choices& choices_;
  double* values_;
  std::size_t size_ = 0;
  double components_[9][capacity] = {};
  double shares_[capacity] = {};       // areas of the pieces as shares of their triangles'
  double twice_areas_[capacity] = {};  // twice the triangles' areas
  double weights_[capacity] = {};      // the product of the two
  std::uint32_t indices_[capacity] = {};
};

}  // namespace fringe::detail
