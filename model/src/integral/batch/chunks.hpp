#pragma once

#include <cstddef>
#include <span>

#include "fringe/triangle_batch.hpp"
#include "geometry/plate_frame.hpp"
#include "integral/batch/choices.hpp"
#include "integral/batch/kernels.hpp"

namespace fringe::detail {

/// Consecutive elements.
struct Range {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Triangles that are integrated together: few enough to stay in the fastest cache, and the parts into which
/// a sum is cut, whatever the number of threads.
constexpr std::size_t chunk_size = 512;

/// Sets values[0…count) to the integrals of the triangles from `begin`; count is at most chunk_size.
void integrate_chunk(const BatchKernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                     std::size_t count, const PlateFrame& plate, const Choices& choices, double* values);

/// The sum of the integrals of the triangles from begin to end.
double sum_range(const BatchKernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                 std::size_t end, const PlateFrame& plate, const Choices& choices);

/// The sum of the integrals of the triangles of many ranges. Short ones are gathered, so that registers are
/// full.
double sum_ranges(const BatchKernels& kernels, const TriangleBatch& triangles, std::span<const Range> ranges,
                  const PlateFrame& plate, const Choices& choices);

/// A plate's frame as the kernels take it.
PlateCoordinates plate_coordinates(const PlateFrame& plate);

}  // namespace fringe::detail
