#pragma once

#include "numeric/product_kernels.hpp"

/// The product kernels for one instruction set, which `Lanes` stands for.
namespace fringe::detail {

template <class Number, class Lanes>
class ProductKernelsFor {
  using Count = std::ptrdiff_t;
  using Matrix = MatrixView<Number>;
  using Factors = VectorsView<const double>;
  using Sums = VectorsView<double>;

 public:
  static void add_product(const Matrix& matrix, const Factors& vectors, const Sums& sums, Count count) {
    for (Count first = 0; first < count; first += most_together)
      multiply<most_together, false>(count - first, matrix, from(vectors, first), from(sums, first));
  }

  static void add_transposed_product(const Matrix& matrix, const Factors& vectors, const Sums& sums,
                                     Count count) {
    for (Count first = 0; first < count; first += most_together)
      multiply<most_together, true>(count - first, matrix, from(vectors, first), from(sums, first));
  }

  static constexpr ProductKernels<Number> kernels{&add_product, &add_transposed_product};

 private:
  using Vector = typename Lanes::Vector;
  static constexpr Count width = Lanes::width;

  /// Number of vectors whose sums are held in registers.
  static constexpr Count most_together = 6;

  static Vector load(const float* from) { return Lanes::load_singles(from); }
  static Vector load(const double* from) { return Vector::load_unaligned(from); }

  template <class Value>
  static VectorsView<Value> from(const VectorsView<Value>& vectors, Count first) {
    return {vectors.values + first * vectors.stride, vectors.stride};
  }

  /// Runs the loops that are compiled for exactly `count` vectors, or for `most` if there are more.
  template <Count most, bool is_transposed>
  static void multiply(Count count, const Matrix& matrix, const Factors& vectors, const Sums& sums) {
    if constexpr (most > 1) {
      if (count < most) {
        multiply<most - 1, is_transposed>(count, matrix, vectors, sums);
        return;
      }
    }
    if (matrix.rows < width)
      multiply_singly<most, is_transposed>(matrix, vectors, sums);
    else if constexpr (is_transposed)
      multiply_columns<most>(matrix, vectors, sums);
    else
      multiply_rows<most>(matrix, vectors, sums);
  }

  template <Count count, bool is_transposed>
  static void multiply_singly(const Matrix& matrix, const Factors& vectors, const Sums& sums) {
    for (Count k = 0; k < matrix.columns; ++k)
      for (Count n = 0; n < count; ++n)
        for (Count row = 0; row < matrix.rows; ++row) {
          const Count in = is_transposed ? row : k, out = is_transposed ? k : row;
          sums.values[n * sums.stride + out] += static_cast<double>(matrix.values[k * matrix.stride + row]) *
                                                vectors.values[n * vectors.stride + in];
        }
  }

  template <Count count>
  static void multiply_rows(const Matrix& matrix, const Factors& vectors, const Sums& sums) {
    Count row = 0;
    for (; row + width <= matrix.rows; row += width) {
      Vector found[count];
      for (Count n = 0; n < count; ++n)
        found[n] = Vector::load_unaligned(sums.values + n * sums.stride + row);
      add_rows<count>(matrix, row, vectors, found);
      for (Count n = 0; n < count; ++n)
        found[n].store_unaligned(sums.values + n * sums.stride + row);
    }
    if (row == matrix.rows)
      return;
    // The last registers overlap rows that are done.
    const Count first = matrix.rows - width;
    Vector found[count];
    for (Count n = 0; n < count; ++n)
      found[n] = Vector(0);
    add_rows<count>(matrix, first, vectors, found);
    for (Count n = 0; n < count; ++n) {
      double last[width];
      found[n].store_unaligned(last);
      for (Count k = row; k < matrix.rows; ++k)
        sums.values[n * sums.stride + k] += last[k - first];
    }
  }

  template <Count count>
  static void add_rows(const Matrix& matrix, Count row, const Factors& vectors, Vector (&found)[count]) {
    for (Count k = 0; k < matrix.columns; ++k) {
      const Vector column = load(matrix.values + k * matrix.stride + row);
      for (Count n = 0; n < count; ++n)
        found[n] = fma(Vector(vectors.values[n * vectors.stride + k]), column, found[n]);
    }
  }

  template <Count count>
  static void multiply_columns(const Matrix& matrix, const Factors& vectors, const Sums& sums) {
    const Count whole = matrix.rows / width * width, first = matrix.rows - width;
    // The last registers overlap rows that are done, which count as zero there.
    Vector last[count];
    for (Count n = 0; n < count; ++n) {
      double values[width];
      for (Count k = 0; k < width; ++k)
        values[k] = first + k < whole ? 0 : vectors.values[n * vectors.stride + first + k];
      last[n] = Vector::load_unaligned(values);
    }
    for (Count k = 0; k < matrix.columns; ++k) {
      const Number* const column = matrix.values + k * matrix.stride;
      const Vector rest = load(column + first);
      Vector found[count];
      for (Count n = 0; n < count; ++n)
        found[n] = rest * last[n];
      for (Count row = 0; row < whole; row += width) {
        const Vector values = load(column + row);
        for (Count n = 0; n < count; ++n)
          found[n] = fma(values, Vector::load_unaligned(vectors.values + n * vectors.stride + row), found[n]);
      }
      for (Count n = 0; n < count; ++n)
        sums.values[n * sums.stride + k] += hadd(found[n]);
    }
  }
};

}  // namespace fringe::detail
