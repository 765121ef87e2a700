#include "numeric/products.hpp"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "instruction_sets.hpp"
#include "numeric/product_kernels.hpp"

/// Tests the products of matrices and vectors against Eigen's.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

class ProductKernelsTest : public testing::TestWithParam<InstructionSet> {};

template <class Number>
void multiply_blocks(InstructionSet set) {
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  const auto& products = kernels<ProductKernels<Number>>(set);
  for (const Index rows : {1, 5, 8, 12, 37})
    for (const Index columns : {1, 4, 9})
      for (const Index count : {1, 3, 6, 8}) {
        const Matrix whole = Matrix::Random(rows + 2, columns);
        const MatrixXd matrix = whole.middleRows(1, rows).template cast<double>();
        const MatrixXd x = MatrixXd::Random(columns + 2, count), y = MatrixXd::Random(rows + 3, count);
        const MatrixXd before = MatrixXd::Random(rows, count), across = MatrixXd::Random(columns, count);
        MatrixXd sums = before, transposed = across;
        const MatrixView<Number> view{whole.data() + 1, rows, columns, whole.rows()};
        products.add_product(view, {x.data() + 1, x.rows()}, {sums.data(), rows}, count);
        products.add_transposed_product(view, {y.data() + 2, y.rows()}, {transposed.data(), columns}, count);
        EXPECT_LT((sums - before - matrix * x.middleRows(1, columns)).norm(), 1e-14 * rows * columns);
        EXPECT_LT((transposed - across - matrix.transpose() * y.middleRows(2, rows)).norm(),
                  1e-14 * rows * columns);
      }
}

TEST_P(ProductKernelsTest, MultiplyABlockInSinglePrecision) {
  multiply_blocks<float>(GetParam());
}

TEST_P(ProductKernelsTest, MultiplyABlockInDoublePrecision) {
  multiply_blocks<double>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, ProductKernelsTest, testing::ValuesIn(available_instruction_sets()),
                         test::name_of_set);

// Larger than the blocks that a cache holds.
TEST(Products, AddWhatALargeMatrixGives) {
  const MatrixXd matrix = MatrixXd::Random(300, 530), x = MatrixXd::Random(530, 7),
                 y = MatrixXd::Random(300, 7);
  MatrixXd sums = MatrixXd::Ones(300, 7), transposed = MatrixXd::Ones(530, 7);
  add_product(matrix, x, sums);
  add_transposed_product(matrix, y, transposed);
  EXPECT_LT((sums - MatrixXd::Ones(300, 7) - matrix * x).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((transposed - MatrixXd::Ones(530, 7) - matrix.transpose() * y).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
