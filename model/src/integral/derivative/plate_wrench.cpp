#include "integral/derivative/plate_wrench.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/plate_frame.hpp"
#include "integral/batch/choices.hpp"
#include "integral/batch/chunks.hpp"
#include "integral/derivative/kernels.hpp"
#include "integral/pieces.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Distance, as a share of the plate's lengths, below which a triangle counts as touching: rounding of the
/// coordinates decides there.
constexpr double touching = 0x1p-44;

/// Sums along a plate's axes, in the kernels' order.
using Sums = std::array<double, wrench_components>;

/// Buffer for the pieces of triangles that border planes cross.
class PlacedPieceBuffer {
 public:
  PlacedPieceBuffer(const PlateFrame& plate, double scale, double least_distance, Sums& sums)
      : plate_(plate), scale_(scale), least_distance_(least_distance), sums_(sums) {}

  /// Cuts a triangle at the border planes and stores the pieces.
  void add(const Triangle& triangle, double twice_area) {
    for_each_piece(plate_, to_local(plate_, triangle),
                   [&](Cell cell, const Vector3d& a, const Vector3d& b, const Vector3d& c, double share) {
                     if (size_ == capacity)
                       flush();
                     const Vector3d* corners[] = {&a, &b, &c};
                     for (std::size_t i = 0; i < 3; ++i) {
                       const Vector3d vector = from_plate(plate_, cell, *corners[i]);
                       for (std::size_t axis = 0; axis < 3; ++axis)
                         vectors_[3 * i + axis][size_] = vector[static_cast<Eigen::Index>(axis)];
                       for (std::size_t axis = 0; axis < 2; ++axis)
                         nearest_[2 * i + axis][size_] =
                             (*corners[i] - vector)[static_cast<Eigen::Index>(axis)];
                     }
                     weights_[size_++] = share * twice_area;
                   });
  }

  /// Adds the stored pieces to the sums.
  void flush() {
    if (size_ == 0)
      return;
    PlacedPieces pieces;
    for (std::size_t k = 0; k < 9; ++k)
      pieces.vectors[k] = vectors_[k];
    for (std::size_t k = 0; k < 6; ++k)
      pieces.nearest[k] = nearest_[k];
    pieces.weight = weights_;
    best_kernels<DerivativeKernels>().add_pieces(pieces, size_, scale_, derivative_choices(), least_distance_,
                                                 sums_.data());
    size_ = 0;
  }

 private:
  static constexpr std::size_t capacity = 256;

  const PlateFrame& plate_;
  double scale_;
  double least_distance_;
  Sums& sums_;
  std::size_t size_ = 0;
  double vectors_[9][capacity] = {};
  double nearest_[6][capacity] = {};
  double weights_[capacity] = {};
};

}  // namespace

Wrench plate_wrench(const TriangleBatch& triangles, const Rectangle& plate) {
  validate(plate);
  const PlateFrame frame = plate_frame(plate);
  const double lengths = frame.length_u + frame.length_v;
  // Squares of lengths neither overflow nor underflow if the plate has a length of about 1.
  const double scale = std::ldexp(1.0, std::clamp(-std::ilogb(lengths), -1000, 1000));
  const double least_distance = touching * scale * lengths;
  const auto& kernels = best_kernels<DerivativeKernels>();
  Sums sums{};
  PlacedPieceBuffer pieces(frame, scale, least_distance, sums);
  std::array<std::uint32_t, chunk_size> left;
  for (std::size_t begin = 0; begin < triangles.size(); begin += chunk_size) {
    const std::size_t count = std::min(chunk_size, triangles.size() - begin);
    const std::size_t left_count =
        kernels.add_triangles(arrays_from(triangles, begin), count, plate_coordinates(frame), scale,
                              derivative_choices(), least_distance, sums.data(), left.data());
    for (const std::uint32_t index : std::span(left).first(left_count))
      pieces.add(triangles[begin + index], triangles.twice_area()[begin + index]);
  }
  pieces.flush();
  // d falls along −v/d, and so 1/d changes by −v/d³ times the displacement.
  const Vector3d force(sums[0], sums[1], sums[2]), about_corner(sums[3], sums[4], sums[5]);
  Wrench wrench;
  wrench.force = -(frame.axes.transpose() * force);
  wrench.torque = frame.corner.cross(wrench.force) - frame.axes.transpose() * about_corner / scale;
  if (!wrench.force.allFinite() || !wrench.torque.allFinite())
    wrench.force = wrench.torque = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return wrench;
}

}  // namespace fringe::detail
