#pragma once

#include <cstddef>

/// Products of small matrices and few vectors, in the widest registers of the processor. All vectors are
/// multiplied at once, so that a matrix is read from memory once.
///
/// Compiled once for every instruction set: what is declared here obeys the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// A matrix in single precision, whose columns follow each other. What is multiplied and added is in double
/// precision.
struct MatrixView {
  const float* values;
  std::ptrdiff_t rows;
  std::ptrdiff_t columns;
};

/// Vectors, and how many values apart they begin.
template <class Number>
struct VectorsView {
  Number* values;
  std::ptrdiff_t stride;
};

/// The kernels for one instruction set.
struct ProductKernels {
  /// Adds matrix·vectors to the sums.
  void (*add_product)(const MatrixView& matrix, const VectorsView<const double>& vectors,
                      const VectorsView<double>& sums, std::ptrdiff_t count);

  /// Adds matrixᵀ·vectors to the sums.
  void (*add_transposed_product)(const MatrixView& matrix, const VectorsView<const double>& vectors,
                                 const VectorsView<double>& sums, std::ptrdiff_t count);
};

}  // namespace fringe::detail
