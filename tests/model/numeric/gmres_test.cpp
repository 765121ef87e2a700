/// Tests the method of generalised minimal residuals.

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "numeric/gmres.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;

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

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
