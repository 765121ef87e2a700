#pragma once

#include "integral/tree/kernels.hpp"

/// The kernels of surface trees for one instruction set, given by the template parameter `Lanes`.
namespace fringe::detail {

template <class Lanes>
class TreeKernelsFor {
 public:
  static void multiply(const double* factor, const double* coordinate, std::size_t size, double* product) {
    for (std::size_t i = 0; i < size; i += width)
      (V::load_unaligned(factor + i) * V::load_unaligned(coordinate + i)).store_unaligned(product + i);
  }

  static double sum(const double* terms, std::size_t size) {
    V partial[parts];
    for (V& part : partial)
      part = V(0);
    for (std::size_t i = 0; i < size; i += array_padding)
      for (std::size_t part = 0; part < parts; ++part)
        partial[part] = partial[part] + V::load_unaligned(terms + i + part * width);
    double sums[array_padding];
    for (std::size_t part = 0; part < parts; ++part)
      partial[part].store_unaligned(sums + part * width);
    double total = 0;
    for (const double one : sums)
      total += one;
    return total;
  }

  static std::size_t eliminate(const ColumnArray& columns, const std::size_t* listed, std::size_t count,
                               const double* pivot, std::size_t pivot_row, std::size_t next_row) {
    const double inverse = 1 / pivot[pivot_row];
    double largest = -1;
    std::size_t largest_at = 0;
    for (std::size_t k = 0; k < count; ++k) {
      double* const column = columns.first + listed[k] * columns.stride;
      const double share = column[pivot_row] * inverse;
      const V shares(share);
      for (std::size_t i = 0; i < columns.stride; i += width)
        (V::load_unaligned(column + i) - shares * V::load_unaligned(pivot + i)).store_unaligned(column + i);
      column[pivot_row] = share;
      const double next = __builtin_fabs(column[next_row]);
      if (next > largest) {
        largest = next;
        largest_at = k;
      }
    }
    return largest_at;
  }

  static double longest_step(const double* coefficients, const double* weights, double slack,
                             double smallest_coefficient, std::size_t size) {
    // A positive or too small coefficient gets a tiny denominator, which makes the quotient larger than any
    // weight.
    constexpr double smallest_denominator = 1e-300, smallest_share = 1e-3;
    const V slacks(slack), least(smallest_share * slack), too_small(smallest_coefficient),
        denominators(smallest_denominator);
    V steps[parts];
    for (V& step : steps)
      step = V(__builtin_inf());
    for (std::size_t i = 0; i < size; i += array_padding)
      for (std::size_t part = 0; part < parts; ++part) {
        const V room = V::load_unaligned(weights + i + part * width) + slacks;
        const V below = V(0) - V::load_unaligned(coefficients + i + part * width) - too_small;
        const V step = max(room, least) / max(below, denominators);
        steps[part] = min(step, steps[part]);
      }
    double shortest[array_padding];
    for (std::size_t part = 0; part < parts; ++part)
      steps[part].store_unaligned(shortest + part * width);
    double result = shortest[0];
    for (const double step : shortest)
      result = step < result ? step : result;
    return result;
  }

  static void measure_heights(const Plane& plane, const double* x, const double* y, const double* z,
                              std::size_t size, double* heights) {
    const V nx(plane.normal[0]), ny(plane.normal[1]), nz(plane.normal[2]), height(plane.height);
    std::size_t i = 0;
    for (; i + width <= size; i += width)
      (nx * V::load_unaligned(x + i) + ny * V::load_unaligned(y + i) + nz * V::load_unaligned(z + i) - height)
          .store_unaligned(heights + i);
    for (; i < size; ++i)
      heights[i] = plane.normal[0] * x[i] + plane.normal[1] * y[i] + plane.normal[2] * z[i] - plane.height;
  }

  static constexpr TreeKernels kernels{&multiply, &sum, &eliminate, &longest_step, &measure_heights};

 private:
  using V = typename Lanes::Vector;
  static constexpr std::size_t width = Lanes::width;
  static constexpr std::size_t parts = array_padding / width;
};

}  // namespace fringe::detail
