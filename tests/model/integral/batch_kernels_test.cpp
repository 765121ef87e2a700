#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"
#include "instruction_sets.hpp"
#include "integral/batch/choices.hpp"
#include "integral/batch/chunks.hpp"
#include "integral/batch/kernels.hpp"
#include "integral/tree/kernels.hpp"

/// Compares the kernels of every instruction set that the machine can run: those of batches with the code for
/// single triangles, those of surface trees with plain loops.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using namespace detail;
using Eigen::Vector3d;
using test::Random;

constexpr double infinity = std::numeric_limits<double>::infinity();
const Rectangle plate{{0, 0, 0}, {0.1, 0, 0}, {0, 0.08, 0}};

class BatchKernelsTest : public testing::TestWithParam<InstructionSet> {
 protected:
  const BatchKernels& kernels_ = kernels<BatchKernels>(GetParam());

  std::vector<double> integrals(const std::vector<Triangle>& triangles, double tolerance = 0) {
    const PreparedChoices choices(tolerance);
    const TriangleBatch batch(triangles);
    std::vector<double> values(triangles.size());
    for (std::size_t begin = 0; begin < values.size(); begin += chunk_size)
      integrate_chunk(kernels_, batch, begin, std::min(chunk_size, values.size() - begin), plate_frame(plate),
                      choices.choices(), values.data() + begin);
    return values;
  }
};

double exact(const Triangle& triangle) {
  return plate_integral(triangle, plate);
}

/// Returns random triangles around the plate whose size is a given share of their distance from it.
std::vector<Triangle> around_the_plate(double size_over_distance, std::size_t count) {
  Random random(3);
  const PlateFrame frame = plate_frame(plate);
  std::vector<Triangle> triangles;
  while (triangles.size() < count) {
    const Vector3d centre = random.in_box({-0.2, -0.2, -0.2}, {0.3, 0.3, 0.2});
    const double size = size_over_distance * distance(frame, centre);
    const auto vertex = [&]() -> Vector3d { return centre + size * random.in_box({-1, -1, -1}, {1, 1, 1}); };
    const Triangle triangle{vertex(), vertex(), vertex()};
    // Slivers are left out: rounding of their vertices changes their area too much.
    if (twice_area(triangle) > 0.1 * size * size)
      triangles.push_back(triangle);
  }
  return triangles;
}

TEST_P(BatchKernelsTest, AgreeWithTheSingleTriangleWithinTheTolerance) {
  for (const double tolerance : {0.0, 1e-12, 1e-9, 1e-6, 1e-3})
    for (const double size_over_distance : {0.01, 0.05, 0.2, 0.6}) {
      const std::vector<Triangle> triangles = around_the_plate(size_over_distance, 1000);
      const std::vector<double> values = integrals(triangles, tolerance);
      for (std::size_t i = 0; i < triangles.size(); ++i)
        EXPECT_NEAR(values[i], exact(triangles[i]), (tolerance + 4e-15) * values[i])
            << tolerance << ", " << size_over_distance << ", triangle " << i;
    }
}

TEST_P(BatchKernelsTest, MeasureLargeTrianglesOverAllBorders) {
  Random random(4);
  std::vector<Triangle> triangles;
  triangles.reserve(500);
  for (int i = 0; i < 500; ++i)
    triangles.push_back(random.triangle_in_box({-0.3, -0.3, 0.02}, {0.4, 0.4, 0.1}));
  const std::vector<double> values = integrals(triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    EXPECT_NEAR(values[i], exact(triangles[i]), 1e-14 * values[i]) << i;
}

TEST_P(BatchKernelsTest, FindContactAndMissingArea) {
  const Triangle crossing{Vector3d(0.05, 0.04, -0.01), {0.06, 0.04, 0.02}, {0.05, 0.05, 0.02}};
  const Triangle on_edge{Vector3d(0, 0, 0), {0.1, 0, 0}, {0.05, -0.05, 0.05}};
  const Triangle one_vertex{Vector3d(0.05, 0.04, 0), {0.06, 0.04, 0.02}, {0.05, 0.05, 0.02}};
  const Triangle no_area{Vector3d(0.05, 0.04, 0), {0.06, 0.04, 0}, {0.07, 0.04, 0}};
  const std::vector<double> values = integrals({crossing, on_edge, one_vertex, no_area, crossing});
  EXPECT_EQ(values[0], infinity);
  EXPECT_EQ(values[1], infinity);
  EXPECT_NEAR(values[2], exact(one_vertex), 4e-15 * values[2]);
  EXPECT_EQ(values[3], 0);
  EXPECT_EQ(values[4], infinity);
}

TEST_P(BatchKernelsTest, ScaleWithTheLength) {
  const Triangle triangle{Vector3d(-0.1, 0.2, 0.1), {0.03, 0.25, 0.2}, {-0.2, 0.1, 0.15}};
  for (const double factor : {1e-70, 1e-30, 1e30, 1e70}) {
    const Rectangle scaled{factor * plate.corner, factor * plate.edge_u, factor * plate.edge_v};
    const std::vector<Triangle> triangles{{factor * triangle[0], factor * triangle[1], factor * triangle[2]}};
    double value = 0;
    integrate_chunk(kernels_, TriangleBatch(triangles), 0, 1, plate_frame(scaled),
                    full_precision_choices().choices(), &value);
    EXPECT_NEAR(value / factor, exact(triangle), 1e-14 * exact(triangle)) << factor;
  }
}

TEST_P(BatchKernelsTest, KeepTheAreaOfSlivers) {
  // The area is a small difference of products. Without fused multiply-add, or exact products in its place, a
  // sliver's area loses as many digits as it is thin.
  Random random(7);
  constexpr std::size_t count = 64;
  std::vector<std::vector<double>> coordinates(9, std::vector<double>(count));
  std::vector<double> twice(count), squared_size(count);
  const double* pointers[9];
  std::vector<Triangle> slivers;
  slivers.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d a = random.in_box({-1, -1, -1}, {1, 1, 1}), b = random.in_box({-1, -1, -1}, {1, 1, 1});
    const Vector3d off = 1e-10 * random.in_box({-1, -1, -1}, {1, 1, 1});
    slivers.push_back({a, b, a + random.uniform(0.1, 0.9) * (b - a) + off});
    for (std::size_t k = 0; k < 9; ++k)
      coordinates[k][i] = slivers[i][k / 3][static_cast<Eigen::Index>(k % 3)];
  }
  for (std::size_t k = 0; k < 9; ++k)
    pointers[k] = coordinates[k].data();
  kernels_.measure(pointers, count, twice.data(), squared_size.data());
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_NEAR(twice[i], twice_area(slivers[i]), 1e-15 * twice[i]) << i;
}

TEST_P(BatchKernelsTest, SumOverNodes) {
  Random random(5);
  constexpr std::size_t count = 13, readable = 16;
  std::vector<double> x(readable), y(readable), z(readable), weight(readable);
  const PlateFrame frame = plate_frame(plate);
  double expected = 0;
  for (std::size_t i = 0; i < readable; ++i) {
    const Vector3d point = random.in_box({-0.2, -0.2, 0.01}, {0.3, 0.3, 0.2});
    x[i] = point.x(), y[i] = point.y(), z[i] = point.z();
    // Elements beyond the count have weight zero.
    weight[i] = i < count ? random.uniform(0, 1) : 0;
    expected += weight[i] / distance(frame, frame.axes * (point - frame.corner));
  }
  EXPECT_NEAR(
      kernels_.sum_over_nodes(plate_coordinates(frame), x.data(), y.data(), z.data(), weight.data(), count),
      expected, 1e-14 * expected);
}

TEST_P(BatchKernelsTest, SoftInverseDistances) {
  Random random(6);
  constexpr std::size_t rows = 5, columns = 16;
  constexpr double squared_softness = 1e-3;
  Eigen::Matrix3Xd points(3, rows);
  std::vector<double> x(columns), y(columns), z(columns), values(rows * columns);
  for (std::size_t i = 0; i < rows; ++i)
    points.col(static_cast<Eigen::Index>(i)) = random.in_box({-0.2, -0.2, -0.2}, {0.3, 0.3, 0.2});
  for (std::size_t i = 0; i < columns; ++i) {
    const Vector3d point = random.in_box({-0.2, -0.2, -0.2}, {0.3, 0.3, 0.2});
    x[i] = point.x(), y[i] = point.y(), z[i] = point.z();
  }
  kernels_.soft_inverse_distances({x.data(), y.data(), z.data()}, columns, points.data(), rows,
                                  squared_softness, values.data());
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < columns; ++i) {
      const Vector3d between = points.col(static_cast<Eigen::Index>(row)) - Vector3d(x[i], y[i], z[i]);
      const double expected = 1 / std::sqrt(between.squaredNorm() + squared_softness);
      EXPECT_NEAR(values[row * columns + i], expected, 1e-15 * expected) << row << ' ' << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, BatchKernelsTest, testing::ValuesIn(available_instruction_sets()),
                         test::name_of_set);

std::vector<double> numbers(std::size_t count, unsigned seed) {
  Random random(seed);
  std::vector<double> result(count);
  std::generate(result.begin(), result.end(), [&] { return random.uniform(-1, 1); });
  return result;
}

/// Surface trees have the same kernels, bit for bit, with every instruction set.
class TreeKernelsTest : public testing::TestWithParam<InstructionSet> {
 protected:
  const TreeKernels& kernels_ = kernels<TreeKernels>(GetParam());
};

constexpr std::size_t size = 5 * array_padding;

TEST_P(TreeKernelsTest, MultiplyAndSum) {
  const std::vector<double> a = numbers(size, 1), b = numbers(size, 2);
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
  std::vector<double> columns = numbers(count * size, 3), expected = columns;
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
  std::vector<double> coefficients = numbers(size, 4), weights = numbers(size, 5);
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
  const std::vector<double> x = numbers(size, 6), y = numbers(size, 7), z = numbers(size, 8);
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
}  // namespace fringe::FRINGE_TEST_FILE
