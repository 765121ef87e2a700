#include "chunks.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "piece_buffer.hpp"

namespace fringe::detail {

PlateCoordinates plate_coordinates(const PlateFrame& plate) {
  PlateCoordinates coordinates;
  for (int i = 0; i < 3; ++i) {
    coordinates.corner[i] = plate.corner[i];
    for (int j = 0; j < 3; ++j)
      coordinates.axes[3 * i + j] = plate.axes(i, j);
  }
  coordinates.length_u = plate.length_u;
  coordinates.length_v = plate.length_v;
  return coordinates;
}

namespace {

/// The triangles that the kernels left out, cut at all borders.
void integrate_left(const Kernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                    std::span<std::uint32_t> left, const PlateFrame& plate, const Choices& choices,
                    double* values) {
  std::sort(left.begin(), left.end());
  const auto end = std::unique(left.begin(), left.end());
  PieceBuffer pieces(kernels, choices, values);
  for (auto index = left.begin(); index != end; ++index) {
    values[*index] = 0;
    pieces.add(plate, to_local(plate, triangles[begin + *index]), triangles.twice_area()[begin + *index],
               *index);
  }
  pieces.flush();
}

}  // namespace

void integrate_chunk(const Kernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                     std::size_t count, const PlateFrame& plate, const Choices& choices, double* values) {
  TriangleArrays arrays;
  for (std::size_t k = 0; k < 9; ++k)
    arrays.coordinates[k] = triangles.coordinate(k) + begin;
  arrays.twice_area = triangles.twice_area() + begin;
  arrays.squared_size = triangles.squared_size() + begin;
  std::fill_n(values, count, 0.0);
  std::array<std::uint32_t, TriangleArrays::most_pieces * chunk_size> left;
  const std::size_t left_count =
      kernels.integrate(arrays, count, plate_coordinates(plate), choices, values, left.data());
  if (left_count > 0)
    integrate_left(kernels, triangles, begin, std::span(left).first(left_count), plate, choices, values);
}

double sum_range(const Kernels& kernels, const TriangleBatch& triangles, std::size_t begin, std::size_t end,
                 const PlateFrame& plate, const Choices& choices) {
  std::array<double, chunk_size> values;
  double sum = 0;
  for (std::size_t first = begin; first < end; first += chunk_size) {
    const std::size_t count = std::min(chunk_size, end - first);
    integrate_chunk(kernels, triangles, first, count, plate, choices, values.data());
    double chunk = 0;
    for (std::size_t i = 0; i < count; ++i)
      chunk += values[i];
    sum += chunk;
  }
  return sum;
}

}  // namespace fringe::detail
