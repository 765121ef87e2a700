#include "fringe/batch_integral.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/triangle_batch.hpp"
#include "integral/batch/chunks.hpp"
#include "integral/batch/kernels.hpp"
#include "integral/derivative/plate_wrench.hpp"
#include "numeric/parallel.hpp"
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

namespace {

using namespace detail;

/// Number of chunks in one parallel task: some 100 µs of work.
constexpr std::size_t chunks_per_task = 16;

void validate(double tolerance, int threads) {
  if (!(tolerance >= 0) || std::isinf(tolerance))
    throw InputError(fmt::format("tolerance {} must be finite and not negative", tolerance));
  if (threads < 0)
    throw InputError(fmt::format("threads {} must not be negative", threads));
}

/// Calls work(i) for 0 ≤ i < count, in parallel unless there is little work.
template <class Work>
void for_each_chunk(std::size_t count, int threads, const Work& work) {
  parallel_for((count + chunks_per_task - 1) / chunks_per_task, static_cast<std::size_t>(threads),
               [&](std::size_t part) {
                 const std::size_t first = part * chunks_per_task;
                 for (std::size_t i = first; i < std::min(first + chunks_per_task, count); ++i)
                   work(i);
               });
}

/// The quadrature choices for a tolerance: prepared for this call, or the shared ones for full precision.
class ChoicesFor {
 public:
  explicit ChoicesFor(double tolerance) {
    if (tolerance > full_precision)
      prepared_.emplace(tolerance);
  }

  Choices operator*() const { return prepared_ ? prepared_->choices() : full_precision_choices().choices(); }

 private:
  std::optional<PreparedChoices> prepared_;
};

std::size_t chunks_of(const TriangleBatch& triangles) {
  return (triangles.size() + chunk_size - 1) / chunk_size;
}

std::size_t chunk_count(const TriangleBatch& triangles, std::size_t chunk) {
  return std::min(chunk_size, triangles.size() - chunk * chunk_size);
}

}  // namespace

std::vector<double> plate_integrals(const TriangleBatch& triangles, const Rectangle& plate, double tolerance,
                                    int threads) {
  validate(plate);
  validate(tolerance, threads);
  const ChoicesFor choices(tolerance);
  const PlateFrame frame = plate_frame(plate);
  const auto& kernels = best_kernels<BatchKernels>();
  std::vector<double> values(triangles.size());
  for_each_chunk(chunks_of(triangles), threads, [&](std::size_t chunk) {
    integrate_chunk(kernels, triangles, chunk * chunk_size, chunk_count(triangles, chunk), frame, *choices,
                    values.data() + chunk * chunk_size);
  });
  return values;
}

std::vector<BoundedIntegral> total_integrals(const TriangleBatch& triangles,
                                             std::span<const Rectangle> plates, double tolerance,
                                             int threads) {
  for (std::size_t i = 0; i < plates.size(); ++i) {
    try {
      validate(plates[i]);
    } catch (const InputError& error) {
      throw InputError(fmt::format("plate {}: {}", i, error.what()));
    }
  }
  validate(tolerance, threads);
  const ChoicesFor choices(tolerance);
  const auto& kernels = best_kernels<BatchKernels>();
  std::vector<PlateFrame> frames;
  for (const Rectangle& plate : plates)
    frames.push_back(plate_frame(plate));
  const std::size_t chunks = chunks_of(triangles);
  std::vector<double> sums(plates.size() * chunks);
  for_each_chunk(sums.size(), threads, [&](std::size_t i) {
    const std::size_t begin = i % chunks * chunk_size;
    sums[i] = sum_range(kernels, triangles, begin, begin + chunk_count(triangles, i % chunks),
                        frames[i / chunks], *choices);
  });
  std::vector<BoundedIntegral> totals;
  for (std::size_t plate = 0; plate < plates.size(); ++plate) {
    double total = 0;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk)
      total += sums[plate * chunks + chunk];
    totals.push_back({total, tolerance * total});
  }
  return totals;
}

IntegralDerivatives total_derivatives(const TriangleBatch& triangles, const Rectangle& plate) {
  const Wrench wrench = plate_wrench(triangles, plate);
  return {wrench.force, wrench.torque};
}

}  // namespace fringe
