#pragma once

#include <array>
#include <cstddef>
#include <optional>

/// Finds the point of a simplex nearest to the origin (model/NUMERICS.md, section 13).
namespace fringe::detail {

/// A face of a simplex, and its point nearest to the origin: Σ weightsᵢ pᵢ / Σ weightsᵢ over the points of
/// the face, all weights positive. The weights of other points are not set.
template <class Number>
struct NearestFace {
  unsigned members;  ///< bit i: whether point i belongs to the face
  std::array<Number, 4> weights;
};

/// The subsets of four points as bit sets, in order of size.
constexpr std::array<unsigned, 15> subsets_by_size{1, 2, 4, 8, 3, 5, 6, 9, 10, 12, 7, 11, 13, 14, 15};

constexpr bool holds(unsigned subset, std::size_t point) {
  return ((subset >> point) & 1U) != 0;
}

/// Finds the smallest face that contains the point, nearest to the origin, of the hull of `size` points, by
/// Johnson's determinants. In exact arithmetic there always is one, even if the points are affinely
/// dependent; in floating point it may happen that no face passes the test. product(i, j, k) is pᵢ·(pⱼ − pₖ).
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
