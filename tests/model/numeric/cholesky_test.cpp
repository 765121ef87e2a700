#include "numeric/cholesky.hpp"
#include "numeric/products.hpp"

#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fringe/interruption.hpp"
#include "instruction_sets.hpp"
#include "numeric/gmres.hpp"
#include "numeric/product_kernels.hpp"

/// Tests the factor of symmetric matrices, and the method of generalised minimal residuals for others.
/// Tests the products of matrices and vectors against Eigen's.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Returns the matrix of 1/(1 + (i − j)²): symmetric and positive definite.
MatrixXd lorentzian(Index size) {
  return MatrixXd::NullaryExpr(size, size, [](Index row, Index column) {
    return 1 / (1 + std::pow(static_cast<double>(row - column), 2));
  });
}

// Of sizes below, at and above those of blocks.
TEST(Cholesky, FactorisesAndSolves) {
  for (const Index size : {1, 7, 64, 65, 300}) {
    const MatrixXd matrix = lorentzian(size);
    const Cholesky found(matrix.triangularView<Eigen::Lower>());
    ASSERT_TRUE(found.is_positive_definite());
    const MatrixXd lower = found.factor().triangularView<Eigen::Lower>();
    EXPECT_LT((lower * lower.transpose() - matrix).cwiseAbs().maxCoeff(), 1e-13);
    const MatrixXd solution = MatrixXd::Random(size, 3);
    EXPECT_LT((found.solve(matrix * solution) - solution).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT((found.solve_lower(lower * solution) - solution).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(Cholesky, GivesTheSameBitsOnAnyNumberOfThreads) {
  const MatrixXd matrix = lorentzian(400), right_sides = MatrixXd::Random(400, 50);
  const Cholesky one(matrix, 1), two(matrix, 2);
  EXPECT_EQ(one.solve(right_sides), two.solve(right_sides));
}

TEST(Cholesky, TellsWhetherAMatrixIsPositiveDefinite) {
  MatrixXd matrix = lorentzian(100);
  matrix(90, 90) = -1e-3;
  EXPECT_FALSE(Cholesky(matrix).is_positive_definite());
  EXPECT_FALSE(Cholesky(MatrixXd::Ones(3, 3) * -1).is_positive_definite());
  EXPECT_FALSE(Cholesky().is_positive_definite());
}

TEST(Cholesky, IsInterrupted) {
  const InterruptionScope scope([] { return true; });
  EXPECT_THROW(Cholesky(lorentzian(500)), Interrupted);
}

/// Returns a matrix that is not symmetric, its diagonal rising.
MatrixXd rising_matrix(Eigen::Index size) {
  MatrixXd result(size, size);
  for (Eigen::Index row = 0; row < size; ++row)
    for (Eigen::Index column = 0; column < size; ++column)
      result(row, column) =
          row == column ? static_cast<double>(row + 1) : 0.3 / static_cast<double>(1 + row + 2 * column);
  return result;
}

TEST(Gmres, SolvesSeveralColumnsOneOfThemZero) {
  constexpr Eigen::Index size = 60;
  const MatrixXd matrix = rising_matrix(size);
  MatrixXd right_sides = MatrixXd::Zero(size, 3);
  right_sides.col(0).setOnes();
  right_sides(7, 2) = 5;
  const auto found = gmres([&](const MatrixXd& columns) { return MatrixXd(matrix * columns); },
                           [&](const MatrixXd& columns) {
                             return MatrixXd(matrix.diagonal().cwiseInverse().asDiagonal() * columns);
                           },
                           right_sides, 1e-10, 40);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - matrix.partialPivLu().solve(right_sides)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Gmres, ReturnsNothingIfTheStepsDoNotSuffice) {
  const MatrixXd matrix = rising_matrix(60);
  const auto same = [](const MatrixXd& columns) { return columns; };
  EXPECT_FALSE(gmres([&](const MatrixXd& columns) { return MatrixXd(matrix * columns); }, same,
                     MatrixXd::Ones(60, 1), 1e-10, 3)
                   .has_value());
}

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
