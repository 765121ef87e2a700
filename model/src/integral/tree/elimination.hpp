#pragma once

#include <cstddef>
#include <span>

namespace fringe::detail {

/// Columns are padded with zeros to a multiple of the longest vector of doubles.
constexpr std::size_t column_padding = 8;

/// Columns that lie one after the other, `stride` apart, a multiple of the padding.
struct ColumnArray {
  double* first;
  std::size_t stride;
};

/// A step of Gauss–Jordan elimination. From each of the listed columns it subtracts the multiple of the pivot
/// column that takes the element in the pivot's row to zero, and puts that multiple in its place. Returns the
/// place in the list of the column that then has the largest absolute value in another row, where the next
/// pivot will be sought.
std::size_t eliminate_columns(const ColumnArray& columns, std::span<const std::size_t> listed,
                              const double* pivot, std::size_t pivot_row, std::size_t next_row);

/// How far all weights can go along the coefficients before one falls below −slack, where only coefficients
/// below −smallest_coefficient count: min (weightᵢ + slack)/−coefficientᵢ, or a little more. The size is a
/// multiple of the padding.
double longest_step(const double* coefficients, const double* weights, double slack,
                    double smallest_coefficient, std::size_t size);

}  // namespace fringe::detail
