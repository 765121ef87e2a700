#pragma once

#include <cstddef>

/// The array loops in which building and evaluating a surface tree spend their time. Each performs the same
/// operations in the same order whatever the register width, so that all instruction sets give the same
/// result.
///
/// The kernels are compiled once for every instruction set: the declarations here obey the rule in
/// simd/dispatch.hpp.
namespace fringe::detail {

/// Number of doubles to a multiple of which arrays are padded with zeros: the width of the longest vector
/// register.
constexpr std::size_t array_padding = 8;

/// Consecutive columns, `stride` elements apart. The stride is a multiple of the padding.
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

  /// Adds up a padded array in array_padding partial sums.
  double (*sum)(const double* terms, std::size_t size);

  /// Performs a step of Gauss–Jordan elimination. Subtracts from each of the listed columns the multiple of
  /// the pivot column that makes the element in the pivot's row zero, and stores that multiple in its place.
  /// Returns the position in the list of the column that then has the largest absolute value in the row
  /// `next_row`, where the next pivot will be sought.
  std::size_t (*eliminate)(const ColumnArray& columns, const std::size_t* listed, std::size_t count,
                           const double* pivot, std::size_t pivot_row, std::size_t next_row);

  /// Returns how far all weights can move along the coefficients before one falls below −slack: min (weightᵢ
  /// + slack)/−coefficientᵢ, or slightly more, over the coefficients below −smallest_coefficient. Both arrays
  /// are padded.
  double (*longest_step)(const double* coefficients, const double* weights, double slack,
                         double smallest_coefficient, std::size_t size);

  /// Sets heights[i] to the signed height of point i above the plane. These arrays need no padding.
  void (*measure_heights)(const Plane& plane, const double* x, const double* y, const double* z,
                          std::size_t size, double* heights);
};

}  // namespace fringe::detail
