#include "reduced/packed_factor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;

constexpr Index side = PackedFactor::block;
constexpr auto tile_size = static_cast<std::size_t>(side * side);
static_assert(side == node_block);

void transpose(const float* tile, float* transposed) {
  for (std::size_t a = 0; a < side; ++a)
    for (std::size_t b = 0; b < side; ++b)
      transposed[b * side + a] = tile[a * side + b];
}

}  // namespace

void PackedFactor::resize(Index blocks, Index right_sides) {
  blocks_ = blocks;
  all_blocks_ = blocks + (right_sides + block - 1) / block;
  offsets_.clear();
  std::size_t size = 0;
  for (Index row = 0; row < all_blocks_; ++row) {
    offsets_.push_back(size);
    size += tile_size * static_cast<std::size_t>(std::min(row + 1, blocks_));
  }
  values_.assign(size, 0.0F);
  inverses_.resize(tile_size * static_cast<std::size_t>(blocks_));
}

void PackedFactor::multiply(Index a, Index b, Index columns, float* products) const {
  best_kernels<NodeKernels>().combine(
      {values_.data() + offsets_[static_cast<std::size_t>(a)], columns * block},
      {values_.data() + offsets_[static_cast<std::size_t>(b)], block, block}, products);
}

bool PackedFactor::factorise(Index first, Index end) {
  const auto& kernels = best_kernels<NodeKernels>();
  std::array<float, tile_size> sums{}, transposed{};
  for (Index column = first; column < end; ++column) {
    for (Index row = column; row < all_blocks_; ++row) {
      float* const tile = &(*this)(row * block, column * block);
      if (column > 0) {
        multiply(row, column, column, sums.data());
        for (std::size_t k = 0; k < tile_size; ++k)
          tile[k] -= sums[k];
      }
      if (row == column) {
        if (!factorise_diagonal(column))
          return false;
        transpose(inverses_.data() + static_cast<std::size_t>(column) * tile_size, transposed.data());
        continue;
      }
      kernels.combine({tile, block}, {transposed.data(), block, block}, sums.data());
      std::copy(sums.begin(), sums.end(), tile);
    }
  }
  return true;
}

/// Factorises a diagonal block and inverts its factor.
bool PackedFactor::factorise_diagonal(Index at) {
  std::array<std::array<double, side>, side> factor{}, inverse{};
  float* const tile = &(*this)(at * block, at * block);
  for (std::size_t c = 0; c < side; ++c) {
    for (std::size_t r = c; r < side; ++r) {
      double value = tile[c * side + r];
      for (std::size_t k = 0; k < c; ++k)
        value -= factor[r][k] * factor[c][k];
      if (r == c && !(value > 0))
        return false;
      factor[r][c] = r == c ? std::sqrt(value) : value / factor[c][c];
    }
  }
  for (std::size_t c = 0; c < side; ++c)
    for (std::size_t r = c; r < side; ++r) {
      double value = r == c ? 1 : 0;
      for (std::size_t k = c; k < r; ++k)
        value -= factor[r][k] * inverse[k][c];
      inverse[r][c] = value / factor[r][r];
    }
  float* const inverted = inverses_.data() + static_cast<std::size_t>(at) * tile_size;
  for (std::size_t r = 0; r < side; ++r)
    for (std::size_t c = 0; c < side; ++c) {
      tile[c * side + r] = static_cast<float>(factor[r][c]);
      inverted[r * side + c] = static_cast<float>(inverse[r][c]);
    }
  return true;
}

void PackedFactor::solve_transposed(Index first, Index end, std::vector<float>& vectors, Index count) {
  const auto& kernels = best_kernels<NodeKernels>();
  const auto sets = static_cast<std::size_t>(count);
  sums_.resize(sets * side);
  std::array<float, tile_size> transposed{};
  for (Index row = end - 1; row >= first; --row) {
    float* const own = vectors.data() + static_cast<std::size_t>(row * block) * sets;
    // Row c of the inverse is column c of its transpose.
    kernels.combine({inverses_.data() + static_cast<std::size_t>(row) * tile_size, block},
                    {own, count, count}, sums_.data());
    for (std::size_t r = 0; r < side; ++r)
      for (std::size_t set = 0; set < sets; ++set)
        own[r * sets + set] = sums_[set * side + r];
    for (Index column = 0; column < row; ++column) {
      transpose(&values_[place(row * block, column * block)], transposed.data());
      kernels.combine({transposed.data(), block}, {own, count, count}, sums_.data());
      float* const others = vectors.data() + static_cast<std::size_t>(column * block) * sets;
      for (std::size_t c = 0; c < side; ++c)
        for (std::size_t set = 0; set < sets; ++set)
          others[c * sets + set] -= sums_[set * side + c];
    }
  }
}

}  // namespace fringe::detail
