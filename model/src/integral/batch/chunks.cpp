#include "integral/batch/chunks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "geometry/plate_frame.hpp"
#include "integral/kernel.hpp"
#include "integral/pieces.hpp"

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

TriangleArrays arrays_from(const TriangleBatch& triangles, std::size_t begin) {
  TriangleArrays arrays;
  for (std::size_t k = 0; k < 9; ++k)
    arrays.coordinates[k] = triangles.coordinate(k) + begin;
  arrays.twice_area = triangles.twice_area() + begin;
  arrays.squared_size = triangles.squared_size() + begin;
  return arrays;
}

namespace {

Triangle triangle_at(const TriangleArrays& triangles, std::size_t index) {
  Triangle triangle;
  for (std::size_t vertex = 0; vertex < 3; ++vertex)
    for (std::size_t axis = 0; axis < 3; ++axis)
      triangle[vertex][static_cast<Eigen::Index>(axis)] = triangles.coordinates[3 * vertex + axis][index];
  return triangle;
}

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

PieceBuffer::PieceBuffer(const BatchKernels& kernels, const Choices& choices, double* values)
    : kernels_(kernels), choices_(choices), values_(values) {}

void PieceBuffer::add(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area,
                      std::uint32_t index) {
  using Eigen::Vector3d;
  for_each_piece(plate, triangle,
                 [&](Cell cell, const Vector3d& a, const Vector3d& b, const Vector3d& c, double share) {
                   if (size_ == capacity)
                     flush();
                   const Vector3d corners[] = {from_plate(plate, cell, a), from_plate(plate, cell, b),
                                               from_plate(plate, cell, c)};
                   for (int corner = 0; corner < 3; ++corner)
                     for (int axis = 0; axis < 3; ++axis)
                       components_[3 * corner + axis][size_] = corners[corner][axis];
                   shares_[size_] = share;
                   twice_areas_[size_] = twice_area;
                   weights_[size_] = share * twice_area;
                   indices_[size_++] = index;
                 });
}

void PieceBuffer::flush() {
  // The last register may extend beyond the stored pieces: it then reads zeros or earlier pieces, whose
  // results are discarded.
  VirtualTriangles pieces;
  for (int k = 0; k < 9; ++k)
    pieces.components[k] = components_[k];
  pieces.weight = weights_;
  double results[capacity] = {};
  std::uint32_t left[capacity];
  const std::size_t left_count = kernels_.integrate_virtual(pieces, size_, choices_, results, left);
  // A piece with a denormal share may have weight zero but still be in contact with the plate.
  for (std::size_t i = 0; i < left_count; ++i)
    results[left[i]] = twice_areas_[left[i]] * (shares_[left[i]] * careful_kernel(left[i]));
  for (std::size_t i = 0; i < size_; ++i)
    values_[indices_[i]] += results[i];
  size_ = 0;
}

double PieceBuffer::careful_kernel(std::size_t piece) const {
  return kernel_from_plate(corner(piece, 0), corner(piece, 1), corner(piece, 2));
}

Eigen::Vector3d PieceBuffer::corner(std::size_t piece, std::size_t which) const {
  return {components_[3 * which][piece], components_[3 * which + 1][piece],
          components_[3 * which + 2][piece]};
}

/// Integrates the triangles that the kernels left out, cutting each at all border planes.
void integrate_left(const BatchKernels& kernels, const TriangleArrays& triangles,
                    std::span<std::uint32_t> left, const PlateFrame& plate, const Choices& choices,
                    double* values) {
  std::sort(left.begin(), left.end());
  const auto end = std::unique(left.begin(), left.end());
  PieceBuffer pieces(kernels, choices, values);
  for (auto index = left.begin(); index != end; ++index) {
    values[*index] = 0;
    pieces.add(plate, to_local(plate, triangle_at(triangles, *index)), triangles.twice_area[*index], *index);
  }
  pieces.flush();
}

/// Sets values[0…count) to the integrals of triangles; count is at most chunk_size.
void integrate_arrays(const BatchKernels& kernels, const TriangleArrays& triangles, std::size_t count,
                      const PlateFrame& plate, const Choices& choices, double* values) {
  std::fill_n(values, count, 0.0);
  std::array<std::uint32_t, TriangleArrays::most_pieces * chunk_size> left;
  const std::size_t left_count =
      kernels.integrate(triangles, count, plate_coordinates(plate), choices, values, left.data());
  if (left_count > 0)
    integrate_left(kernels, triangles, std::span(left).first(left_count), plate, choices, values);
}

double sum_of(const double* values, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum += values[i];
  return sum;
}

/// Buffer that gathers triangles from short ranges and adds up their integrals.
class Gathering {
 public:
  Gathering(const BatchKernels& kernels, const PlateFrame& plate, const Choices& choices)
      : kernels_(kernels), plate_(plate), choices_(choices) {}

  void add(const TriangleArrays& triangles, std::size_t count) {
    if (size_ + count > capacity)
      flush();
    for (std::size_t k = 0; k < 9; ++k)
      copy(triangles.coordinates[k], count, numbers_[k]);
    copy(triangles.twice_area, count, numbers_[9]);
    copy(triangles.squared_size, count, numbers_[10]);
    size_ += count;
  }

  double sum() {
    flush();
    return sum_;
  }

  /// Number of triangles in the buffer: enough to fill long registers, few enough to stay in the fastest
  /// cache.
  static constexpr std::size_t capacity = 256;

 private:
  void copy(const double* from, std::size_t count, double* numbers) const {
    for (std::size_t i = 0; i < count; ++i)
      numbers[size_ + i] = from[i];
  }

  void flush() {
    if (size_ == 0)
      return;
    // Whole registers are read: the triangles after the last one get zero area.
    for (std::size_t i = size_; i % TriangleArrays::padding != 0; ++i)
      for (auto& numbers : numbers_)
        numbers[i] = 0;
    TriangleArrays arrays;
    for (std::size_t k = 0; k < 9; ++k)
      arrays.coordinates[k] = numbers_[k];
    arrays.twice_area = numbers_[9];
    arrays.squared_size = numbers_[10];
    std::array<double, capacity> values;
    integrate_arrays(kernels_, arrays, size_, plate_, choices_, values.data());
    sum_ += sum_of(values.data(), size_);
    size_ = 0;
  }

  const BatchKernels& kernels_;
  const PlateFrame& plate_;
  const Choices& choices_;
  double numbers_[11][capacity];  // only the first size_ of each are set
  std::size_t size_ = 0;
  double sum_ = 0;
};

}  // namespace

void integrate_chunk(const BatchKernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                     std::size_t count, const PlateFrame& plate, const Choices& choices, double* values) {
  integrate_arrays(kernels, arrays_from(triangles, begin), count, plate, choices, values);
}

double sum_range(const BatchKernels& kernels, const TriangleBatch& triangles, std::size_t begin,
                 std::size_t end, const PlateFrame& plate, const Choices& choices) {
  std::array<double, chunk_size> values;
  double sum = 0;
  for (std::size_t first = begin; first < end; first += chunk_size) {
    const std::size_t count = std::min(chunk_size, end - first);
    integrate_chunk(kernels, triangles, first, count, plate, choices, values.data());
    sum += sum_of(values.data(), count);
  }
  return sum;
}

double sum_ranges(const BatchKernels& kernels, const TriangleBatch& triangles, std::span<const Range> ranges,
                  const PlateFrame& plate, const Choices& choices) {
  Gathering gathering(kernels, plate, choices);
  double sum = 0;
  for (const auto& [first, count] : ranges) {
    if (count < Gathering::capacity)
      gathering.add(arrays_from(triangles, first), count);
    else
      sum += sum_range(kernels, triangles, first, first + count, plate, choices);
  }
  return sum + gathering.sum();
}

}  // namespace fringe::detail
