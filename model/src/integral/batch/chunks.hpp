#pragma once

#include <cstddef>
#include <span>

#include "fringe/triangle_batch.hpp"
#include "geometry/plate_frame.hpp"
#include "integral/batch/choices.hpp"
#include "integral/batch/kernels.hpp"

namespace fringe::detail {

/// A range of consecutive elements.
struct Range {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Number of triangles that are integrated together: few enough to stay in the fastest cache. Sums are split
/// into parts of this size whatever the number of threads.
constexpr std::size_t chunk_size = 512;

/// Sets values[0…count) to the integrals of the triangles from `begin`; count is at most chunk_size.
void integrate_chunk(const BatchKernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                     std::size_t count, const PlateFrame& plate, const Choices& choices, double* values);

/// Adds up the integrals of the triangles from begin to end.
double sum_range(const BatchKernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                 std::size_t end, const PlateFrame& plate, const Choices& choices);

/// Adds up the integrals of the triangles of several ranges. Short ranges are gathered so that registers are
/// full.
double sum_ranges(const BatchKernels& kernels, const TriangleBatch& triangles, std::span<const Range> ranges,
                  const PlateFrame& plate, const Choices& choices);

/// Converts a plate's frame to the form that the kernels take.
PlateCoordinates plate_coordinates(const PlateFrame& plate);

/// Returns the arrays of the triangles from `begin`.
TriangleArrays arrays_from(const TriangleBatch& triangles, std::size_t begin);

}  // namespace fringe::detail
