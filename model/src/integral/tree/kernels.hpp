#pragma once

#include <cstddef>

/// The loops over arrays of numbers that making and evaluating a surface tree spends its time on. Each takes
/// the same operations in the same order whatever the register, so that all instruction sets give the same
/// result.
///
/// Compiled once for every instruction set: what is declared here obeys the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// Arrays are padded with zeros to a multiple of the longest vector of doubles.
constexpr std::size_t array_padding = 8;

/// Columns that lie one after the other, `stride` apart, a multiple of the padding.
struct ColumnArray {
  double* first;
  std::size_t stride;
};

/// A plane n·p = height.
struct Plane {
  double normal[3];
  double height;
};

/// The functions for one instruction set.
struct TreeKernels {
  /// Sets product[i] to factor[i]·coordinate[i] in a padded array.
  void (*multiply)(const double* factor, const double* coordinate, std::size_t size, double* product);

  /// Adds up a padded array, in array_padding partial sums.
  double (*sum)(const double* terms, std::size_t size);

  /// Does a step of Gauss–Jordan elimination. From each of the listed columns it subtracts the multiple of
  /// the pivot column that takes the element in the pivot's row to zero, and puts that multiple in its place.
  /// Returns the place in the list of the column that then has the largest absolute value in another row,
  /// where the next pivot will be sought.
  std::size_t (*eliminate)(const ColumnArray& columns, const std::size_t* listed, std::size_t count,
                           const double* pivot, std::size_t pivot_row, std::size_t next_row);

  /// Returns how far all weights can go along the coefficients before one falls below −slack, where only
  /// coefficients below −smallest_coefficient count: min (weightᵢ + slack)/−coefficientᵢ, or a little more.
  /// Both arrays are padded.
  double (*longest_step)(const double* coefficients, const double* weights, double slack,
                         double smallest_coefficient, std::size_t size);

  /// Sets heights[i] to how far point i is above the plane. These arrays need no padding.
  void (*measure_heights)(const Plane& plane, const double* x, const double* y, const double* z,
                          std::size_t size, double* heights);
};

}  // namespace fringe::detail
