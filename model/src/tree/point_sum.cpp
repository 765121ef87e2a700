#include "point_sum.hpp"

#include <algorithm>

namespace fringe::detail {

void PointSum::add(const PointArrays& arrays, const Range& range) {
  count_ += range.count;
  for (std::size_t done = 0; done < range.count;) {
    const std::size_t count = std::min(range.count - done, capacity - size_);
    const std::size_t from = range.first + done;
    std::copy_n(arrays.x.data() + from, count, x_.data() + size_);
    std::copy_n(arrays.y.data() + from, count, y_.data() + size_);
    std::copy_n(arrays.z.data() + from, count, z_.data() + size_);
    std::copy_n(arrays.weight.data() + from, count, weight_.data() + size_);
    size_ += count;
    done += count;
    if (size_ == capacity)
      flush();
  }
}

double PointSum::sum() {
  flush();
  return sum_;
}

void PointSum::flush() {
  if (size_ == 0)
    return;
  const std::size_t last = size_ - 1;
  // Whole registers are read: what is beyond the last point weighs nothing, and is nowhere near the plate.
  for (std::size_t i = size_; i % TriangleArrays::padding != 0; ++i) {
    x_[i] = x_[last];
    y_[i] = y_[last];
    z_[i] = z_[last];
    weight_[i] = 0;
  }
  sum_ += kernels_.sum_over_nodes(plate_, x_.data(), y_.data(), z_.data(), weight_.data(), size_);
  size_ = 0;
}

}  // namespace fringe::detail
