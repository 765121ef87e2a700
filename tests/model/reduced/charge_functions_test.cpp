#include "reduced/charge_functions.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "bem/bodies.hpp"
#include "fringe/pose.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

Scene box_of(double x, double y, double z) {
  Scene scene;
  scene.objects = {{"box", std::nullopt, Cuboid{x, y, z}, Eigen::Isometry3d::Identity(), Grounded{}, true}};
  return scene;
}

double size_of(const ChargeFunctions::Part& part) {
  return part.box.diagonal().squaredNorm();
}

TEST(ChargeFunctions, PointsHaveTheDipoleMomentsOfTheGivenCharges) {
  const ConductorsAtRest conductors(charged_bodies(box_of(0.5, 0.02, 0.02)), 5e-2, 1000);
  const auto& panels = conductors.mesh().panels();
  // Of both signs, as those of a sensor and of the ground behind it.
  MatrixXd given(index_of(panels.size()), 1);
  for (std::size_t k = 0; k < panels.size(); ++k)
    given(index_of(k), 0) = panels[k].area * (panels[k].centre.y() + 2 * panels[k].centre.z());
  const ChargeFunctions functions(conductors, given, size_of, 8);
  ASSERT_EQ(functions.count(), 8);
  for (std::size_t level = ChargeFunctions::first_with_moments;
       level < ChargeFunctions::points_per_function.size(); ++level)
    for (std::size_t function = 0; function < functions.count(); ++function) {
      Vector3d moments = Vector3d::Zero();
      double largest = 0;
      const FunctionPanels& own = functions.panels();
      for (std::size_t k = own.first[function]; k < own.first[function + 1]; ++k) {
        const Vector3d centre = (own.corners[k][0] + own.corners[k][1] + own.corners[k][2]) / 3;
        moments += own.given(index_of(k), 0) * (centre - functions.centre(function));
        largest += std::abs(own.given(index_of(k), 0)) * functions.radius(function);
      }
      const FunctionPoints& points = functions.points(level);
      double shares = 0;
      for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k) {
        moments -= points.given(index_of(k), 0) * (points.at[k].cast<double>() - functions.centre(function));
        shares += points.shares[k];
      }
      EXPECT_LT(moments.norm(), 1e-5 * largest) << level << ", " << function;
      EXPECT_NEAR(shares, 1, 1e-5);
    }
}

TEST(ChargeFunctions, BelongToOneSideOfAThinBody) {
  constexpr double thickness = 0.02;
  const ConductorsAtRest conductors(charged_bodies(box_of(0.3, 0.3, thickness)), 2e-2, 2000, 500);
  const ChargeFunctions functions(conductors, MatrixXd(index_of(conductors.mesh().panels().size()), 0),
                                  size_of, 64);
  const FunctionPanels& panels = functions.panels();
  for (std::size_t function = 0; function < functions.count(); ++function) {
    double above = 0, below = 0;
    for (std::size_t k = panels.first[function]; k < panels.first[function + 1]; ++k) {
      const double height = (panels.corners[k][0] + panels.corners[k][1] + panels.corners[k][2]).z() / 3;
      (height > 0 ? above : below) += std::abs(height) > 0.49 * thickness ? panels.shares[k] : 0;
    }
    EXPECT_LT(std::min(above, below), 1e-6) << function;
  }
}

TEST(ChargeFunctions, AreAllDividedOnceMoreThanTheirSums) {
  const ConductorsAtRest conductors(charged_bodies(box_of(0.3, 0.3, 0.3)), 2e-2, 2000, 500);
  const ChargeFunctions functions(conductors, MatrixXd(index_of(conductors.mesh().panels().size()), 0),
                                  size_of, 128);
  for (Index sum = 0; sum < functions.coarse().count; ++sum)
    EXPECT_GE(std::ranges::count(functions.coarse().of, sum), 2) << sum;
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
