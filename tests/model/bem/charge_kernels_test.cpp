/// Tests the charge kernels of every instruction set against plain sums and the accurate triangle integral.

#include "bem/charge_kernels.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "bem/jacobi_basis.hpp"
#include "geometry.hpp"
#include "instruction_sets.hpp"
#include "integral/kernel.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

class ChargeKernelsTest : public testing::TestWithParam<InstructionSet> {
 protected:
  const ChargeKernels& kernels_ = kernels<ChargeKernels>(GetParam());
};

RuleView view(const DirectionRule& rule, int functions) {
  return {rule.nodes.size(), functions, rule.weights.rows(), rule.nodes.data(), rule.weights.data()};
}

TEST_P(ChargeKernelsTest, SumTheInverseDistancesOverAFace) {
  const FacePoint point{0.3, -0.2, 0.4, 1, 0.7};
  for (const int functions_u : {1, 7, 9, 31})
    for (const int functions_v : {2, 8, 11})
      for (const int points : {1, 5, 16, 33}) {
        const DirectionRule &u = whole_rule(EdgeKind::thin, points),
                            &v = whole_rule(EdgeKind::right_angle, points + 2);
        const RuleView along_u = view(u, functions_u), along_v = view(v, functions_v);
        std::vector<double> scratch(face_scratch(along_u, along_v));
        MatrixXd result(functions_v, functions_u);
        kernels_.face_potentials(point, along_u, along_v, scratch.data(), result.data());
        MatrixXd inverse(v.nodes.size(), u.nodes.size());
        for (Index q = 0; q < inverse.rows(); ++q)
          for (Index p = 0; p < inverse.cols(); ++p)
            inverse(q, p) = 1 / std::hypot(point.half_u * u.nodes[p] - point.x,
                                           point.half_v * v.nodes[q] - point.y, point.z);
        const MatrixXd wanted =
            v.weights.topRows(functions_v) * inverse * u.weights.topRows(functions_u).transpose();
        EXPECT_LT((result - wanted).norm(), 1e-13 * wanted.norm())
            << functions_u << " " << functions_v << " " << points;
      }
}

/// Calls a kernel for the vectors from points to the corners of a triangle; returns one number a point.
template <typename Kernel>
std::vector<double> at_points(const Kernel& kernel, const std::array<Vector3d, 3>& corners,
                              const std::vector<Vector3d>& points) {
  std::array<std::vector<double>, 9> components;
  const double* columns[9];
  for (std::size_t k = 0; k < 9; ++k) {
    for (const Vector3d& point : points)
      components[k].push_back((corners[k / 3] - point)[static_cast<Index>(k % 3)]);
    columns[k] = components[k].data();
  }
  std::vector<double> result(points.size());
  kernel(columns, points.size(), result.data());
  return result;
}

/// Points in front of the triangle, in its plane, on a side, and at a corner; also for a sliver.
TEST_P(ChargeKernelsTest, ComputeThePotentialOfATriangleAnywhere) {
  test::Random random(3);
  for (const double height : {1.0, 0.02}) {
    const std::array<Vector3d, 3> corners{Vector3d(0, 0, 0), Vector3d(1, 0.1, 0), Vector3d(0.3, height, 0)};
    std::vector<Vector3d> points{(corners[0] + corners[1]) / 2, corners[2], Vector3d(0.4, 0.3 * height, 0),
                                 2 * corners[1], Vector3d(0.5, 0.2 * height, 1e-7)};
    while (points.size() < 40)
      points.emplace_back(random.in_box({-2, -2, -2}, {2, 2, 2}));
    const std::vector<double> potentials = at_points(kernels_.triangle_potentials, corners, points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double wanted =
          2 * kernel(corners[0] - points[k], corners[1] - points[k], corners[2] - points[k]);
      EXPECT_NEAR(potentials[k], wanted, 1e-11 * wanted) << "point " << k << ", height " << height;
    }
  }
}

TEST_P(ChargeKernelsTest, SeeAClosedSurfaceUnderTheWholeSolidAngleFromInsideOnly) {
  const std::array<Vector3d, 4> corners{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0),
                                        Vector3d(0, 0, 1e-3)};
  const std::array<std::array<std::size_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const std::vector<Vector3d> points{{0.3, 0.3, 1e-4}, {0.1, 0.1, 5e-4}, {0.3, 0.3, 1e-2}, {0.2, 0.3, -1e-4},
                                     {2, 1, 0},        {-1, 3, 0.5},     {0.9, 0.9, 1e-4}, {0, 0, -3}};
  std::vector<double> sums(points.size(), 0.0);
  for (const auto& [a, b, c] : faces) {
    const std::vector<double> angles =
        at_points(kernels_.solid_angles, {corners[a], corners[b], corners[c]}, points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      sums[k] += angles[k];
      if (points[k].z() == 0 && c == 1) {
        EXPECT_EQ(angles[k], 0) << "in the plane of the face, point " << k;
      }
    }
  }
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_NEAR(sums[k], k < 2 ? 1 : 0, 1e-12) << "point " << k;
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, ChargeKernelsTest, testing::ValuesIn(available_instruction_sets()),
                         test::name_of_set);

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
