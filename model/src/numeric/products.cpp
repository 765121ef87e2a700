#include "numeric/products.hpp"

#include <algorithm>

#include "numeric/product_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;

/// Calls task(block, first_row, first_column) for the blocks of a matrix, each of which the nearest caches
/// hold while all vectors are multiplied.
template <class Number, class Task>
void for_blocks(const MatrixReference<Number>& matrix, const Task& task) {
  constexpr Index most_rows = 256, most_columns = 128;
  for (Index row = 0; row < matrix.rows(); row += most_rows)
    for (Index column = 0; column < matrix.cols(); column += most_columns)
      task(MatrixView<Number>{matrix.data() + column * matrix.outerStride() + row,
                              std::min(most_rows, matrix.rows() - row),
                              std::min(most_columns, matrix.cols() - column), matrix.outerStride()},
           row, column);
}

VectorsView<const double> rows_of(const MatrixReference<double>& vectors, Index first) {
  return {vectors.data() + first, vectors.outerStride()};
}

VectorsView<double> rows_of(Ref<MatrixXd>& vectors, Index first) {
  return {vectors.data() + first, vectors.outerStride()};
}

template <class Number>
void add(const MatrixReference<Number>& matrix, const MatrixReference<double>& factors, Ref<MatrixXd>& sums) {
  const auto& kernels = best_kernels<ProductKernels<Number>>();
  for_blocks<Number>(matrix, [&](const MatrixView<Number>& block, Index row, Index column) {
    kernels.add_product(block, rows_of(factors, column), rows_of(sums, row), factors.cols());
  });
}

template <class Number>
void add_transposed(const MatrixReference<Number>& matrix, const MatrixReference<double>& factors,
                    Ref<MatrixXd>& sums) {
  const auto& kernels = best_kernels<ProductKernels<Number>>();
  for_blocks<Number>(matrix, [&](const MatrixView<Number>& block, Index row, Index column) {
    kernels.add_transposed_product(block, rows_of(factors, row), rows_of(sums, column), factors.cols());
  });
}

}  // namespace

void add_product(const MatrixReference<double>& matrix, const MatrixReference<double>& factors,
                 Ref<MatrixXd> sums) {
  add<double>(matrix, factors, sums);
}

void add_product(const MatrixReference<float>& matrix, const MatrixReference<double>& factors,
                 Ref<MatrixXd> sums) {
  add<float>(matrix, factors, sums);
}

void add_transposed_product(const MatrixReference<double>& matrix, const MatrixReference<double>& factors,
                            Ref<MatrixXd> sums) {
  add_transposed<double>(matrix, factors, sums);
}

void add_transposed_product(const MatrixReference<float>& matrix, const MatrixReference<double>& factors,
                            Ref<MatrixXd> sums) {
  add_transposed<float>(matrix, factors, sums);
}

}  // namespace fringe::detail
