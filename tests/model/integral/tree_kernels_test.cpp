/// Checks that the kernels of surface trees give bit-identical results with every instruction set.

#include "integral/tree/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "instruction_sets.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

std::vector<double> random_numbers(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> numbers(count);
  std::generate(numbers.begin(), numbers.end(), [&] { return uniform(random); });
  return numbers;
}

class TreeKernelsTest : public testing::TestWithParam<InstructionSet> {
 protected:
  const TreeKernels& kernels_ = kernels<TreeKernels>(GetParam());
};

constexpr std::size_t size = 5 * array_padding;

TEST_P(TreeKernelsTest, MultiplyAndSum) {
  const std::vector<double> a = random_numbers(size, 1), b = random_numbers(size, 2);
  std::vector<double> product(size);
  kernels_.multiply(a.data(), b.data(), size, product.data());
  std::array<double, array_padding> partial{};
  for (std::size_t i = 0; i < size; ++i) {
    EXPECT_EQ(product[i], a[i] * b[i]);
    partial[i % array_padding] += a[i];
  }
  double sum = 0;
  for (const double part : partial)
    sum += part;
  EXPECT_EQ(kernels_.sum(a.data(), size), sum);
}

TEST_P(TreeKernelsTest, EliminateAndNameTheNextPivot) {
  constexpr std::size_t count = 4, pivot_row = 3, next_row = 6;
  const std::vector<std::size_t> listed{2, 0, 3};
  std::vector<double> columns = random_numbers(count * size, 3), expected = columns;
  const double* const pivot = expected.data() + size;
  for (const std::size_t k : listed) {
    double* const column = expected.data() + k * size;
    const double share = column[pivot_row] * (1 / pivot[pivot_row]);
    for (std::size_t i = 0; i < size; ++i)
      column[i] -= share * pivot[i];
    column[pivot_row] = share;
  }
  const std::size_t found = kernels_.eliminate({columns.data(), size}, listed.data(), listed.size(),
                                               columns.data() + size, pivot_row, next_row);
  EXPECT_EQ(columns, expected);
  for (const std::size_t k : listed)
    EXPECT_LE(std::abs(columns[k * size + next_row]), std::abs(columns[listed[found] * size + next_row]));
}

TEST_P(TreeKernelsTest, FindTheLongestStep) {
  std::vector<double> coefficients = random_numbers(size, 4), weights = random_numbers(size, 5);
  for (double& weight : weights)
    weight = std::abs(weight);
  constexpr double slack = 1e-3, smallest = 1e-2;
  double expected = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < size; ++i)
    if (-coefficients[i] > smallest)
      expected = std::min(expected, (weights[i] + slack) / (-coefficients[i] - smallest));
  EXPECT_EQ(kernels_.longest_step(coefficients.data(), weights.data(), slack, smallest, size), expected);
}

TEST_P(TreeKernelsTest, MeasureHeightsOfAnyNumberOfPoints) {
  const std::vector<double> x = random_numbers(size, 6), y = random_numbers(size, 7),
                            z = random_numbers(size, 8);
  const Plane plane{{0.3, -0.5, 0.7}, 0.2};
  for (const std::size_t count : {std::size_t{1}, std::size_t{9}, size}) {
    std::vector<double> heights(count);
    kernels_.measure_heights(plane, x.data(), y.data(), z.data(), count, heights.data());
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(heights[i],
                plane.normal[0] * x[i] + plane.normal[1] * y[i] + plane.normal[2] * z[i] - plane.height);
  }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, TreeKernelsTest, testing::ValuesIn(available_instruction_sets()),
                         test::name_of_set);

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
