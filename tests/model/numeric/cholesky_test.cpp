#include "numeric/cholesky.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "fringe/interruption.hpp"

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

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
