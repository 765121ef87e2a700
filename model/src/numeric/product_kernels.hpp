#pragma once

#include <cstddef>

/// Products of matrices and few vectors, in the widest registers of the processor. All vectors are multiplied
/// at once, so that a matrix is read from memory once.
///
/// Compiled once for every instruction set: what is declared here obeys the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// A matrix or a block of one, stored by columns. What is multiplied and added is in double precision.
template <class Number>
struct MatrixView {
  const Number* values;
  std::ptrdiff_t rows;
  std::ptrdiff_t columns;
  std::ptrdiff_t stride;  ///< how many values apart the columns begin
};

/// Vectors, and how many values apart they begin.
template <class Number>
struct VectorsView {
  Number* values;
  std::ptrdiff_t stride;
};

/// The kernels for one instruction set and matrices in single or double precision.
template <class Number>
struct ProductKernels {
  /// Adds matrix·vectors to the sums.
  void (*add_product)(const MatrixView<Number>& matrix, const VectorsView<const double>& vectors,
                      const VectorsView<double>& sums, std::ptrdiff_t count);

  /// Adds matrixᵀ·vectors to the sums.
  void (*add_transposed_product)(const MatrixView<Number>& matrix, const VectorsView<const double>& vectors,
                                 const VectorsView<double>& sums, std::ptrdiff_t count);
};

}  // namespace fringe::detail
