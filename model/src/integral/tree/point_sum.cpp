#include "integral/tree/point_sum.hpp"

#include <algorithm>

namespace fringe::detail {

void PointSum::add(const PointArrays& arrays, const Range& range) {
  count_ += range.count;
  if (range.count <= most_gathered) {
    gather(arrays, range);
    return;
  }
  const std::size_t whole = range.count / TriangleArrays::padding * TriangleArrays::padding;
  sum_ += kernels_.sum_over_nodes(plate_, arrays.x.data() + range.first, arrays.y.data() + range.first,
                                  arrays.z.data() + range.first, arrays.weight.data() + range.first, whole);
  gather(arrays, {range.first + whole, range.count - whole});
}

double PointSum::sum() {
  flush();
  return sum_;
}

void PointSum::gather(const PointArrays& arrays, const Range& range) {
  if (size_ + range.count > capacity)
    flush();
  for (std::size_t i = 0; i < range.count; ++i) {
    x_[size_ + i] = arrays.x[range.first + i];
    y_[size_ + i] = arrays.y[range.first + i];
    z_[size_ + i] = arrays.z[range.first + i];
    weight_[size_ + i] = arrays.weight[range.first + i];
  }
  size_ += range.count;
}

void PointSum::flush() {
  if (size_ == 0)
    return;
  const std::size_t last = size_ - 1;
  // Whole registers are read: the elements after the last point repeat it with weight zero, at a distance
  // from the plate that is safe to divide by.
  for (std::size_t i = size_; i % TriangleArrays::padding != 0; ++i) {
    x_[i] = x_[last];
    y_[i] = y_[last];
    z_[i] = z_[last];
    weight_[i] = 0;
  }
  sum_ += kernels_.sum_over_nodes(plate_, x_, y_, z_, weight_, size_);
  size_ = 0;
}

}  // namespace fringe::detail
