#include "integral/tree/elimination.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "simd/vector_clones.hpp"

namespace fringe::detail {

// Much of the cost of building a tree is in this loop.
FRINGE_VECTOR_CLONES
std::size_t eliminate_columns(const ColumnArray& columns, std::span<const std::size_t> listed,
                              const double* pivot, std::size_t pivot_row, std::size_t next_row) {
  const double inverse = 1 / pivot[pivot_row];
  double largest = -1;
  std::size_t largest_place = 0;
  for (std::size_t k = 0; k < listed.size(); ++k) {
    double* const __restrict column = columns.first + listed[k] * columns.stride;
    const double share = column[pivot_row] * inverse;
    for (std::size_t i = 0; i < columns.stride; ++i)
      column[i] -= share * pivot[i];
    column[pivot_row] = share;
    if (std::abs(column[next_row]) > largest) {
      largest = std::abs(column[next_row]);
      largest_place = k;
    }
  }
  return largest_place;
}

FRINGE_VECTOR_CLONES
double longest_step(const double* coefficients, const double* weights, double slack,
                    double smallest_coefficient, std::size_t size) {
  // A coefficient that is too small, or positive, leaves a denominator that makes the quotient larger than
  // any weight.
  constexpr double smallest_denominator = 1e-300, smallest_share = 1e-3;
  const double least = smallest_share * slack;
  std::array<double, column_padding> steps;
  steps.fill(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < size; i += column_padding) {
    for (std::size_t lane = 0; lane < column_padding; ++lane) {
      const double room = weights[i + lane] + slack, below = -coefficients[i + lane] - smallest_coefficient;
      const double step =
          (room > least ? room : least) / (below > smallest_denominator ? below : smallest_denominator);
      steps[lane] = step < steps[lane] ? step : steps[lane];
    }
  }
  return *std::min_element(steps.begin(), steps.end());
}

}  // namespace fringe::detail
