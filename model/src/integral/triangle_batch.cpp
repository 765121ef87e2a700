#include "fringe/triangle_batch.hpp"

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "integral/batch/kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe {
TriangleBatch::TriangleBatch(std::span<const Triangle> triangles)
    : size_(triangles.size()),
      // A register may be loaded from any triangle on, hence the padding. The additional cache line keeps the
      // arrays from mapping to the same cache sets.
      stride_((size_ / detail::TriangleArrays::padding + 2) * detail::TriangleArrays::padding),
      numbers_(11 * stride_) {
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t vertex = 0; vertex < 3; ++vertex) {
      if (!triangles[i][vertex].allFinite())
        throw InputError(fmt::format("triangle {}: vertex {} is not finite", i, vertex));
      for (std::size_t axis = 0; axis < 3; ++axis)
        numbers_[(3 * vertex + axis) * stride_ + i] = triangles[i][vertex][static_cast<Eigen::Index>(axis)];
    }
  }
  const double* coordinates[9];
  for (std::size_t k = 0; k < 9; ++k)
    coordinates[k] = coordinate(k);
  detail::best_kernels<detail::BatchKernels>().measure(coordinates, size_, numbers_.data() + 9 * stride_,
                                                       numbers_.data() + 10 * stride_);
}

Triangle TriangleBatch::operator[](std::size_t index) const {
  Triangle triangle;
  for (std::size_t vertex = 0; vertex < 3; ++vertex)
    for (std::size_t axis = 0; axis < 3; ++axis)
      triangle[vertex][static_cast<Eigen::Index>(axis)] = coordinate(3 * vertex + axis)[index];
  return triangle;
}

}  // namespace fringe
