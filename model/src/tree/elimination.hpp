#pragma once

#include <cstddef>
#include <span>

namespace fringe::detail {

/// Columns are padded with zeros to a multiple of the longest vector of doubles.
constexpr std::size_t column_padding = 8;

/// Columns that lie one after the other, `stride` apart, a multiple of the padding.
struct Columns {
  double* first;
  std::size_t stride;
};

/// A step of Gauss–Jordan elimination. From each of the listed columns it subtracts the multiple of the pivot
/// column that takes the element in the pivot's row to zero, and puts that multiple in its place. Returns the
/// place in the list of the column that then has the largest absolute value in another row, where the next
/// pivot will be sought.
std::size_t eliminate_columns(const Columns& columns, std::span<const std::size_t> listed,
                              const double* pivot, std::size_t pivot_row, std::size_t next_row);

}  // namespace fringe::detail
