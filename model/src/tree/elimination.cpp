#include "elimination.hpp"

#include <cmath>

namespace fringe::detail {

// Most of the cost of building a tree is in this loop. Every element takes the same two operations whatever
// the length of the registers, so that all versions give the same result. The address sanitizer cannot run
// before the choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
[[gnu::target_clones("avx512f", "avx2", "default")]]
#endif
std::size_t
eliminate_columns(const Columns& columns, std::span<const std::size_t> listed, const double* pivot,
                  std::size_t pivot_row, std::size_t next_row) {
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

}  // namespace fringe::detail
