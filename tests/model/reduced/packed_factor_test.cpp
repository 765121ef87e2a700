#include "reduced/packed_factor.hpp"

#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

/// Tests Cholesky's method in blocks against that in double precision.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index blocks = 5, sides = 18, size = blocks * PackedFactor::block;

/// Returns a positive definite matrix with a unit diagonal.
MatrixXd matrix() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> numbers(-1, 1);
  const MatrixXd factors = MatrixXd::NullaryExpr(size, size, [&] { return numbers(random); });
  const MatrixXd product = factors * factors.transpose() + 5 * MatrixXd::Identity(size, size);
  const Eigen::VectorXd scales = product.diagonal().cwiseSqrt().cwiseInverse();
  return scales.asDiagonal() * product * scales.asDiagonal();
}

MatrixXd right_sides() {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> numbers(-1, 1);
  return MatrixXd::NullaryExpr(size, sides, [&] { return numbers(random); });
}

TEST(PackedFactor, SolvesForSeveralRightSides) {
  const MatrixXd known = matrix(), right = right_sides();
  PackedFactor factor;
  factor.resize(blocks, sides);
  for (Index column = 0; column < size; ++column) {
    for (Index row = column; row < size; ++row)
      factor(row, column) = static_cast<float>(known(row, column));
    for (Index side = 0; side < sides; ++side)
      factor(factor.rows() + side, column) = static_cast<float>(right(column, side));
  }
  // In two parts, as that of a machine and what is left for the targets.
  ASSERT_TRUE(factor.factorise(0, 3));
  ASSERT_TRUE(factor.factorise(3, blocks));
  std::vector<float> vectors;
  for (Index row = 0; row < size; ++row)
    for (Index side = 0; side < sides; ++side)
      vectors.push_back(factor(factor.rows() + side, row));
  factor.solve_transposed(3, blocks, vectors, sides);
  factor.solve_transposed(0, 3, vectors, sides);
  const MatrixXd expected = known.llt().solve(right);
  constexpr double rounding = 1e-5;
  for (Index row = 0; row < size; ++row)
    for (Index side = 0; side < sides; ++side)
      EXPECT_NEAR(vectors[static_cast<std::size_t>(row * sides + side)], expected(row, side),
                  rounding * expected.norm());
}

TEST(PackedFactor, TellsWhatIsNotPositiveDefinite) {
  PackedFactor factor;
  factor.resize(2, 0);
  for (Index row = 0; row < factor.rows(); ++row)
    factor(row, row) = 1;
  factor(20, 3) = 2;
  EXPECT_FALSE(factor.factorise(0, 2));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
