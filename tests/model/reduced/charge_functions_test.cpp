#include "reduced/charge_functions.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "reduced/charge_skeleton.hpp"
#include "surface/bodies.hpp"

/// Tests that few point charges have the potentials of a body's panels beyond their distance.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

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
  for (Eigen::Index sum = 0; sum < functions.coarse().count; ++sum)
    EXPECT_GE(std::ranges::count(functions.coarse().of, sum), 2) << sum;
}

/// Returns a square of side 2 whose panels carry charges like 1, x and y.
ChargedPanels charged_square(std::vector<Triangle>& triangles) {
  constexpr int cells = 14;
  const auto corner = [](int column, int row) {
    return Vector3d(2.0 * column / cells - 1, 2.0 * row / cells - 1, 0);
  };
  std::vector<Panel> panels;
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      triangles.push_back({corner(column, row), corner(column + 1, row), corner(column + 1, row + 1)});
      triangles.push_back({corner(column, row), corner(column + 1, row + 1), corner(column, row + 1)});
    }
  for (const Triangle& triangle : triangles)
    panels.push_back(make_panel(triangle));
  ChargedPanels body{cluster_panels(panels), {}};
  for (int function = 0; function < 3; ++function)
    for (std::size_t place = 0; place < body.panels.panels.size(); ++place) {
      const Panel& panel = panels[body.panels.panels[place]];
      const double factor = function == 0 ? 1 : panel.centre[function - 1];
      body.charges.push_back(body.panels.is_repeated[place] ? 0.0F : static_cast<float>(factor * panel.area));
    }
  body.charges.resize(body.charges.size() + body.panels.panels.size(), 0.0F);
  return body;
}

/// Returns the potential at a point, with the panels' quarters' quarters as points.
double potential(const ChargedPanels& body, std::size_t function, int fineness, const Vector3d& point) {
  double sum = 0;
  const auto& [x, y, z] = body.panels.points[static_cast<std::size_t>(fineness)];
  for (const PanelCluster& cluster : body.panels.clusters) {
    const MeshPart part{&cluster, fineness};
    for (std::ptrdiff_t k = 0; k < part.count(); ++k) {
      const auto at = static_cast<std::size_t>(part.repeats() * cluster.first + k);
      const auto place = static_cast<std::size_t>(cluster.first + k % cluster.count);
      sum += static_cast<double>(body.charges[function * body.panels.panels.size() + place]) /
             static_cast<double>(part.repeats()) / (Vector3d(x[at], y[at], z[at]) - point).norm();
    }
  }
  return sum;
}

TEST(ChargeSkeleton, HasFewNodesAndThePotentialsOfThePanelsBeyondItsDistance) {
  std::vector<Triangle> triangles;
  const ChargedPanels body = charged_square(triangles);
  const std::vector<TriangleSurface> surfaces{{triangles}};
  constexpr double away = 0.75;
  std::ptrdiff_t fewer = 0;
  for (const double accuracy : {2.5e-3, 1.5e-4}) {
    const std::optional<ChargeSkeleton> skeleton = charge_skeleton(body, 3, surfaces, away, accuracy);
    ASSERT_TRUE(skeleton.has_value());
    EXPECT_LE(skeleton->error, accuracy);
    EXPECT_LE(fewer, skeleton->nodes.places());
    fewer = skeleton->nodes.places();
    EXPECT_LT(fewer, 100);
    for (const Vector3d& point :
         {Vector3d(0.1, 0.2, away), Vector3d(0.9, -0.7, -away), Vector3d(1 + away, 0.3, 0),
          Vector3d(1 + away, 1 + away, 0), Vector3d(0.5, 0.5, 3 + away)}) {
      // Errors are relative to the potentials of all functions; at single points some times the root mean
      // square.
      double square = 0, error = 0;
      for (std::size_t function = 0; function < 3; ++function) {
        const double wanted = potential(body, function, PanelClusters::finest, point);
        square += wanted * wanted;
        error += std::pow(potential(skeleton->nodes, function, 0, point) - wanted, 2);
      }
      EXPECT_LT(std::sqrt(error / square), 3 * accuracy) << fewer;
    }
  }
}

TEST(ChargeSkeleton, CloseToTheBodyKeepsTheChargeSoThatErrorsCancelFarAway) {
  std::vector<Triangle> triangles;
  const ChargedPanels body = charged_square(triangles);
  const std::vector<TriangleSurface> surfaces{{triangles}};
  constexpr double away = 0.1, accuracy = 4e-2;
  const std::optional<ChargeSkeleton> skeleton = charge_skeleton(body, 3, surfaces, away, accuracy);
  ASSERT_TRUE(skeleton.has_value());
  EXPECT_LE(skeleton->error, accuracy);
  EXPECT_LT(skeleton->nodes.places(), 800);
  for (const auto& [point, allowed] :
       {std::pair(Vector3d(0.1, 0.2, away), 3 * accuracy), std::pair(Vector3d(3, 2, 10), 1e-3)}) {
    const double wanted = potential(body, 0, PanelClusters::finest, point);
    EXPECT_NEAR(potential(skeleton->nodes, 0, 0, point), wanted, allowed * wanted);
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
