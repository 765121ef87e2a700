#include "integral/batch/piece_buffer.hpp"

#include "integral/kernel.hpp"
#include "integral/pieces.hpp"

namespace fringe::detail {

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

}  // namespace fringe::detail
