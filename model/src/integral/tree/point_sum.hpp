#pragma once

#include <cstddef>

#include "integral/batch/chunks.hpp"
#include "integral/tree/node.hpp"

namespace fringe::detail {

/// Accumulates Σ w/d over points that come in small ranges, which are gathered so that registers are full.
class PointSum {
 public:
  PointSum(const BatchKernels& kernels, const PlateFrame& plate)
      : kernels_(kernels), plate_(plate_coordinates(plate)) {}

  void add(const PointArrays& arrays, const Range& range);

  double sum();
  std::size_t count() const { return count_; }

 private:
  /// Number of points in the buffer: few enough to stay in the fastest cache, many enough to fill long
  /// registers.
  static constexpr std::size_t capacity = 512;

  /// Number of points in a range up to which it is gathered; longer ranges are summed in place.
  static constexpr std::size_t most_gathered = 32;

  void gather(const PointArrays& arrays, const Range& range);
  void flush();

  const BatchKernels& kernels_;
  PlateCoordinates plate_;
  double x_[capacity], y_[capacity], z_[capacity], weight_[capacity];  // only the first size_ are set
  std::size_t size_ = 0;
  std::size_t count_ = 0;
  double sum_ = 0;
};

}  // namespace fringe::detail
