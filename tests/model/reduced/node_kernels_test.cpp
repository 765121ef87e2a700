/// Tests the node kernels of every instruction set against the same sums in double precision.

#include "reduced/node_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "instruction_sets.hpp"
#include "reduced/node_rules.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Relative rounding error of single precision in sums of a few hundred numbers.
constexpr double rounding = 2e-6;

/// Returns an array with space for what the kernels may write beyond its end.
std::vector<float> room(int count) {
  return std::vector<float>(static_cast<std::size_t>(whole_blocks(count) + node_block), 0.0F);
}

std::vector<float> random_numbers(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> numbers = room(count);
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
    numbers[k] = static_cast<float>(random()) / 2e9F - 1;
  return numbers;
}

Eigen::VectorXd in_doubles(const std::vector<float>& numbers, Index count) {
  return Eigen::Map<const Eigen::VectorXf>(numbers.data(), count).cast<double>();
}

/// Returns weight·function as a matrix (functions, points).
MatrixXd weights_of(const StoredRule& rule, int functions) {
  MatrixXd weights(functions, rule.points);
  for (int k = 0; k < functions; ++k)
    for (int q = 0; q < rule.points; ++q)
      weights(k, q) = rule.weights[static_cast<std::size_t>(k * whole_blocks(rule.points) + q)];
  return weights;
}

class NodeKernelsTest : public testing::TestWithParam<InstructionSet> {
 protected:
  const NodeKernels& kernels_ = kernels<NodeKernels>(GetParam());
};

TEST_P(NodeKernelsTest, AddUpPotentialsAlsoLimitedOnes) {
  constexpr int rows = 5, columns = 37;
  const auto x = random_numbers(rows, 1), y = random_numbers(rows, 2), z = random_numbers(rows, 3),
             charges = random_numbers(rows, 4);
  auto u = random_numbers(columns, 5), v = random_numbers(columns, 6), w = random_numbers(columns, 7);
  // A point that coincides with one of the others.
  u[3] = x[1], v[3] = y[1], w[3] = z[1];
  auto limits = room(columns), found = room(columns);
  for (std::size_t k = 0; k < limits.size(); ++k)
    limits[k] = k % 2 == 0 ? 1.0F : 4.0F;
  constexpr float row_limit = 2;
  const NodePoints of_rows{x.data(), y.data(), z.data(), rows},
      of_columns{u.data(), v.data(), w.data(), columns};
  const auto expected = [&](std::size_t k, bool is_limited) {
    double sum = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double inverse =
          1 / std::hypot(static_cast<double>(x[i]) - u[k], static_cast<double>(y[i]) - v[k],
                         static_cast<double>(z[i]) - w[k]);
      sum += charges[i] * (is_limited ? std::min(inverse, std::min<double>(row_limit, limits[k])) : inverse);
    }
    return sum;
  };
  kernels_.add_up_limited(of_rows, charges.data(), row_limit, of_columns, limits.data(), found.data());
  for (std::size_t k = 0; k < columns; ++k)
    EXPECT_NEAR(found[k], expected(k, true), 5 * row_limit * rounding) << k;
  kernels_.add_up(of_rows, charges.data(), of_columns, found.data());
  for (std::size_t k = 0; k < columns; ++k) {
    if (k == 3)
      continue;
    EXPECT_NEAR(found[k], expected(k, false), rounding * 100) << k;
  }
}

TEST_P(NodeKernelsTest, FillWithInverseDistancesAndApplyThemBothWays) {
  constexpr int rows = 23, columns = 37;
  const auto x = random_numbers(rows, 1), y = random_numbers(rows, 2), z = random_numbers(rows, 3);
  auto u = random_numbers(columns, 4), v = random_numbers(columns, 5), w = random_numbers(columns, 6);
  for (int k = columns; k < whole_blocks(columns); ++k)
    u[static_cast<std::size_t>(k)] = 1e12F;
  std::vector<float> values = room(rows * whole_blocks(columns));
  kernels_.fill({x.data(), y.data(), z.data(), rows}, {u.data(), v.data(), w.data(), columns}, values.data());
  MatrixXd expected(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k) {
      const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(k);
      expected(i, k) =
          1 / std::hypot(static_cast<double>(x[row]) - u[column], static_cast<double>(y[row]) - v[column],
                         static_cast<double>(z[row]) - w[column]);
      EXPECT_NEAR(values[row * static_cast<std::size_t>(whole_blocks(columns)) + column], expected(i, k),
                  rounding * expected(i, k));
    }

  const auto on_rows = random_numbers(rows, 7), on_columns = random_numbers(columns, 8);
  auto at_rows = room(rows), at_columns = room(columns);
  kernels_.apply({values.data(), rows, columns}, on_rows.data(), on_columns.data(), at_rows.data(),
                 at_columns.data());
  const double size = expected.norm();
  EXPECT_LT((in_doubles(at_rows, rows) - expected * in_doubles(on_columns, columns)).norm(), rounding * size);
  EXPECT_LT((in_doubles(at_columns, columns) - expected.transpose() * in_doubles(on_rows, rows)).norm(),
            rounding * size);
}

TEST_P(NodeKernelsTest, SpreadAndGatherTensorProducts) {
  for (const int functions : {1, 3, 5, 15})
    for (const int points_u : {1, 7, 20})
      for (const int points_v : {2, 16, 33, 64}) {
        const StoredRule &u = stored_rule(EdgeKind::thin, points_u),
                         &v = stored_rule(EdgeKind::right_angle, points_v);
        const NodeGrid grid{functions, u.view(), v.view()};
        const MatrixXd weights_u = weights_of(u, functions), weights_v = weights_of(v, functions);

        // Rows of the mapped matrices are along v: they are transposed.
        const auto coefficients = random_numbers(functions * functions, 1);
        auto charges = room(points_u * points_v);
        kernels_.spread(grid, coefficients.data(), charges.data());
        const MatrixXd wanted =
            weights_v.transpose() *
            in_doubles(coefficients, functions * functions).reshaped(functions, functions) * weights_u;
        EXPECT_LT((in_doubles(charges, points_u * points_v) - wanted.reshaped()).norm(),
                  rounding * (1 + wanted.norm()));

        const auto potentials = random_numbers(points_u * points_v, 2);
        auto moments = room(functions * functions);
        kernels_.gather(grid, potentials.data(), moments.data());
        const MatrixXd known = weights_v *
                               in_doubles(potentials, points_u * points_v).reshaped(points_v, points_u) *
                               weights_u.transpose();
        EXPECT_LT((in_doubles(moments, functions * functions) - known.reshaped()).norm(),
                  rounding * (1 + known.norm()));
      }
}

TEST_P(NodeKernelsTest, MultiplyAddAndDot) {
  constexpr int count = 75;
  const int padded = whole_blocks(count);
  const auto matrix = random_numbers(count * padded, 1), vector = random_numbers(count, 2);
  auto product = room(count);
  kernels_.multiply(matrix.data(), count, vector.data(), product.data());
  const MatrixXd square = in_doubles(matrix, Index{count} * padded).reshaped(padded, count).topRows(count);
  EXPECT_LT((in_doubles(product, count) - square * in_doubles(vector, count)).norm(),
            rounding * square.norm());

  const auto a = random_numbers(count, 3), b = random_numbers(count, 4);
  EXPECT_NEAR(kernels_.dot(a.data(), b.data(), padded), in_doubles(a, count).dot(in_doubles(b, count)),
              rounding * count);
  auto sum = b;
  kernels_.add(-0.5F, a.data(), sum.data(), padded);
  EXPECT_LT((in_doubles(sum, count) - in_doubles(b, count) + 0.5 * in_doubles(a, count)).norm(),
            rounding * 10);
}

TEST_P(NodeKernelsTest, CombineRowsWithSetsOfFactors) {
  constexpr int rows = 21, stride = 40;
  const auto values = random_numbers(rows * node_block, 1), factors = random_numbers(rows * stride, 2);
  const MatrixXd blocks = in_doubles(values, rows * Index{node_block}).reshaped(node_block, rows);
  const MatrixXd weights = in_doubles(factors, Index{rows} * stride).reshaped(stride, rows);
  for (const int sets : {1, 7, 16, 33}) {
    std::vector<float> sums(static_cast<std::size_t>(sets) * node_block);
    kernels_.combine({values.data(), rows}, {factors.data(), stride, sets}, sums.data());
    const MatrixXd known = blocks * weights.topRows(sets).transpose();
    EXPECT_LT((in_doubles(sums, Index{sets} * node_block).reshaped(node_block, sets) - known).norm(),
              rounding * (1 + known.norm()));
  }
}

TEST_P(NodeKernelsTest, FindTheNarrowestEllipses) {
  constexpr int points = 16;
  const auto x = random_numbers(points, 1), y = random_numbers(points, 2), z = random_numbers(points, 3);
  // The face has the half sides 0.4 and 0.1 about the origin; the y axis is its normal.
  const FaceMap map{{2.5F, 0, 0, 0, 0, 10, 0, 2.5F, 0}, {0, 0, 0}, 0.25F};
  float least[2];
  kernels_.ellipses({x.data(), y.data(), z.data(), points}, map, least);
  double expected_u = 1e9, expected_v = 1e9;
  const auto sum = [](double at, double height) {
    return std::hypot(at - 1, height) + std::hypot(at + 1, height);
  };
  for (std::size_t k = 0; k < points; ++k) {
    const double above = y[k], beside_u = std::max(std::abs(x[k]) - 0.4, 0.0),
                 beside_v = std::max(std::abs(z[k]) - 0.1, 0.0);
    expected_u = std::min(expected_u, sum(x[k] / 0.4, std::hypot(above, beside_v) / 0.4));
    expected_v = std::min(expected_v, sum(z[k] / 0.1, std::hypot(above, beside_u) / 0.1));
  }
  EXPECT_NEAR(least[0], expected_u, rounding * expected_u);
  EXPECT_NEAR(least[1], expected_v, rounding * expected_v);
}

TEST_P(NodeKernelsTest, LayTheNodesOfAFace) {
  const StoredRule &u = stored_rule(EdgeKind::thin, 5), &v = stored_rule(EdgeKind::thin, 19);
  auto x = room(95), y = room(95), z = room(95);
  kernels_.lay({3, u.view(), v.view()}, {{1, 2, 3}, {0.5F, 0, 0.25F}, {0, -1, 0.125F}}, x.data(), y.data(),
               z.data());
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < 19; ++j) {
      EXPECT_FLOAT_EQ(x[i * 19 + j], 1 + 0.5F * u.nodes[i]);
      EXPECT_FLOAT_EQ(y[i * 19 + j], 2 - v.nodes[j]);
      EXPECT_FLOAT_EQ(z[i * 19 + j], 3 + 0.25F * u.nodes[i] + 0.125F * v.nodes[j]);
    }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, NodeKernelsTest, testing::ValuesIn(available_instruction_sets()),
                         test::name_of_set);

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
