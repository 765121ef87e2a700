#pragma once

#include <array>
#include <cstddef>
#include <optional>

/// The point of a simplex that is nearest to the origin (model/NUMERICS.md, section 13).
namespace fringe::detail {

/// A face of a simplex, and the point of it that is nearest to the origin: Σ weightsᵢ pᵢ / Σ weightsᵢ over
/// the points of the face, all weights positive. Weights of other points are not set.
template <class Number>
struct NearestFace {
  unsigned members;  ///< bit i: whether point i belongs to the face
  std::array<Number, 4> weights;
};

/// The subsets of four points, as bits, the small ones first.
constexpr std::array<unsigned, 15> subsets_by_size{1, 2, 4, 8, 3, 5, 6, 9, 10, 12, 7, 11, 13, 14, 15};

constexpr bool holds(unsigned subset, std::size_t point) {
  return ((subset >> point) & 1U) != 0;
}

/// The smallest face that holds the point of the hull of `size` points nearest to the origin, by Johnson's
/// determinants. In exact arithmetic there always is one, also when the points are affinely dependent; in
/// floating point none of them may pass. product(i, j, k) is pᵢ·(pⱼ − pₖ).
template <class Number, class Product>
std::optional<NearestFace<Number>> nearest_face(const Product& product, std::size_t size) {
  std::array<std::array<Number, 4>, 16> determinants;
  for (std::size_t i = 0; i < size; ++i)
    determinants[1U << i][i] = Number(1);
  for (const unsigned subset : subsets_by_size) {
    if (subset >= (1U << size))
      continue;
    bool nearest = true;
    std::size_t first = 0;
    while (!holds(subset, first))
      ++first;
    for (std::size_t i = first; i < size; ++i)
      nearest = nearest && (!holds(subset, i) || determinants[subset][i] > 0);
    for (std::size_t j = 0; j < size; ++j) {
      if (holds(subset, j))
        continue;
      Number next(0);
      for (std::size_t i = first; i < size; ++i)
        if (holds(subset, i))
          next += determinants[subset][i] * product(i, first, j);
      nearest = nearest && next <= 0;
      determinants[subset | (1U << j)][j] = next;
    }
    if (nearest)
      return NearestFace<Number>{subset, determinants[subset]};
  }
  return std::nullopt;
}

}  // namespace fringe::detail
