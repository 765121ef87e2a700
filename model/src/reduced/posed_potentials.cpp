#include "reduced/posed_potentials.hpp"

#include <algorithm>

#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

constexpr std::size_t in_block = OutsidePotentials::block;

/// Copies blocks of values at some points to the rows of these.
void write_rows(const std::vector<float>& blocks, std::span<const std::size_t> indices, std::size_t columns,
                std::vector<float>& rows) {
  for (std::size_t p = 0; p < indices.size(); ++p)
    for (std::size_t k = 0; k < columns; ++k)
      rows[indices[p] * columns + k] = blocks[k * in_block + p];
}

}  // namespace

void PosedPotentials::evaluate(std::span<const Vector3d> points) {
  const auto given = static_cast<std::size_t>(potentials_.given()),
             rank = static_cast<std::size_t>(answers_.count);
  of_given_.resize(points.size() * given);
  of_answers_.resize(points.size() * rank);
  // Neighbouring points of all bodies share the points of the machine.
  const std::vector<std::size_t> order = along_curve(points);
  std::vector<Vector3d> some;
  for (std::size_t begin = 0; begin < points.size(); begin += in_block) {
    const auto indices = std::span(order).subspan(begin, std::min(in_block, points.size() - begin));
    some.clear();
    for (const std::size_t index : indices)
      some.push_back(points[index]);
    potentials_.evaluate(some, rank > 0, rank > 0 ? &answers_ : nullptr, scratch_);
    write_rows(scratch_.of_given, indices, given, of_given_);
    if (rank > 0)
      write_rows(scratch_.of_charges, indices, rank, of_answers_);
  }
}

MatrixXd PosedPotentials::given(std::size_t first, Index count) const {
  const Eigen::Map<const TrianglePotentials> rows(
      of_given_.data() + first * static_cast<std::size_t>(potentials_.given()), count, potentials_.given());
  return rows.cast<double>();
}

MatrixXd PosedPotentials::answers(std::size_t first, Index count) {
  const auto rank = static_cast<std::size_t>(answers_.count);
  const std::size_t blocks = static_cast<std::size_t>(whole_blocks(count)) / in_block;
  own_.assign(blocks * rank * in_block, 0.0F);
  for (std::size_t p = 0; p < static_cast<std::size_t>(count); ++p)
    for (std::size_t k = 0; k < rank; ++k)
      own_[((p / in_block) * rank + k) * in_block + p % in_block] = of_answers_[(first + p) * rank + k];
  products_.resize(in_block * in_block);
  MatrixXd found(count, count);
  const auto& kernels = best_kernels<NodeKernels>();
  for (std::size_t i = 0; i < blocks; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      kernels.combine({own_.data() + j * rank * in_block, answers_.count},
                      {own_.data() + i * rank * in_block, node_block, node_block}, products_.data());
      const Index row = index_of(i * in_block), column = index_of(j * in_block);
      for (Index a = 0; a < node_block && row + a < count; ++a)
        for (Index b = 0; b < node_block && column + b < count; ++b) {
          const double product = products_[static_cast<std::size_t>(a * node_block + b)];
          found(row + a, column + b) = product;
          found(column + b, row + a) = product;
        }
    }
  return found;
}

}  // namespace fringe::detail
