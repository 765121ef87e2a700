/// Bodies of the reduced method by themselves and in pairs: capacitances in closed form, Coulomb's law,
/// reciprocity, and forces against differences.

#include "reduced/prepared_shape.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "reduced/node_pair.hpp"
#include "reduced/outside_charges.hpp"
#include "reduced/panel_clusters.hpp"
#include "reduced/rigid_bodies.hpp"
#include "reduced/single_body_system.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// Capacitances over 4πε of a cube and a square plate of side 2 (J. Helsing and K.-M. Perfekt, 2013; F. H.
/// Read, 1997).
constexpr double of_cube = 2 * 0.66067815, of_square = 2 * 0.36678931;

double capacitance(const PreparedLevel& level) {
  return level.root * level.root;
}

TEST(PreparedShapes, HaveTheCapacitanceOfTheirShapeTheBetterTheMoreFunctionsTheyHave) {
  PreparedShape cube(box_at_origin({1, 1, 1})), square(plate_at_origin(1, 1));
  double least_of_cube = 0, least_of_square = 0;
  // The finest level takes a second to prepare.
  for (int index = 0; index + 1 < PreparedShape::levels; ++index) {
    const double found = capacitance(cube.level(index)), other = capacitance(square.level(index));
    // Galerkin's energies are lower bounds; numbers are single.
    EXPECT_LT(found, of_cube * (1 + 1e-5));
    EXPECT_LT(other, of_square * (1 + 1e-5));
    EXPECT_GE(found, least_of_cube * (1 - 1e-5));
    EXPECT_GE(other, least_of_square * (1 - 1e-5));
    least_of_cube = found, least_of_square = other;
  }
  EXPECT_NEAR(least_of_cube, of_cube, 2e-3 * of_cube);
  EXPECT_NEAR(least_of_square, of_square, 1e-4 * of_square);
  EXPECT_TRUE(cube.is_box() && square.is_plate() && cube.mesh() == nullptr);
  EXPECT_EQ(cube.edges().size(), 12U);
  EXPECT_EQ(square.edges().size(), 4U);
}

TEST(PreparedShapes, OfTheSameProportionsAreShared) {
  SharedShapes shapes;
  PreparedShape* const plate = shapes.find(FacedSurface(plate_at_origin(1, 0.5)));
  EXPECT_EQ(shapes.find(FacedSurface(plate_at_origin(1, 0.5))), plate);
  EXPECT_NE(shapes.find(FacedSurface(plate_at_origin(1, 0.25))), plate);
  EXPECT_NE(shapes.find(FacedSurface(box_at_origin({1, 0.5, 0.1}))), plate);
}

TEST(PreparedShapes, OfTrianglesHaveTheCapacitanceOfTheirSurface) {
  const std::vector<TriangleSurface> cube{{triangulate(Cuboid{2, 2, 2})}};
  const SingleBodySystem found = solve_single_body(cube, 3e-2, 800);
  const Index count = found.matrix.rows();
  ASSERT_EQ(count, static_cast<Index>(found.mesh.panels().size()));
  const Eigen::VectorXd charges = found.factor.solve(Eigen::VectorXd::Ones(count));
  EXPECT_NEAR(charges.sum(), of_cube, 1e-2 * of_cube);
  EXPECT_LT(charges.sum(), of_cube * (1 + 1e-4));
  EXPECT_GT(charges.minCoeff(), 0);
  // What one density on each group misses is an energy.
  const Eigen::MatrixXd missing =
      missing_energies(found, Eigen::MatrixXd::Ones(count, 1), charges,
                       [](const Vector3d& /*point*/) { return Eigen::RowVectorXd::Ones(1); });
  EXPECT_GT(missing(0, 0), 0);
  EXPECT_LT(missing(0, 0), 0.1 * of_cube);
  // Panels inside of another surface are left out.
  const std::vector<TriangleSurface> nested{cube[0], {triangulate(Cuboid{1, 1, 1})}};
  EXPECT_EQ(panels_of(nested).panels().size(), panels_of(cube).panels().size());
}

/// A box and a plate in a pose, with the charge of each that has unit energy.
class NodePairs : public testing::Test {
 protected:
  static constexpr int level = 1;

  NodePair pair_at(const Eigen::Isometry3d& pose) {
    placed_box.centre = pose.translation();
    placed_box.axes = pose.linear();
    NodePair pair;
    constexpr double gap = 0.3;
    const PairSmoothness smooth = smoothness(placed_box, placed_plate, gap);
    const int functions = functions_of_level(level);
    pair.place(placed_box, smooth.a, functions, placed_plate, smooth.b, functions, gap, {12, 12});
    return pair;
  }
  /// Returns charge_a · moments_a and charge_b · moments_b, of charges on the other.
  std::array<double, 2> energies(const Eigen::Isometry3d& pose) {
    std::vector<float> on_box(static_cast<std::size_t>(of_box.padded + node_block)),
        on_plate(static_cast<std::size_t>(of_plate.padded + node_block));
    pair_at(pose).potentials(of_box.equilibrium.data(), of_plate.equilibrium.data(), on_box.data(),
                             on_plate.data());
    const auto product = [](const std::vector<float>& charges, const std::vector<float>& moments,
                            std::ptrdiff_t count) {
      double sum = 0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
        sum += static_cast<double>(charges[k]) * static_cast<double>(moments[k]);
      return sum;
    };
    return {product(of_box.equilibrium, on_box, of_box.count),
            product(of_plate.equilibrium, on_plate, of_plate.count)};
  }

  PreparedShape box{FacedSurface(box_at_origin({1, 0.6, 0.4}))}, plate{FacedSurface(plate_at_origin(1, 0.5))};
  const PreparedLevel &of_box = box.level(level), &of_plate = plate.level(level);
  PlacedBody placed_box{&box, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()},
      placed_plate{&plate, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()};
};

TEST_F(NodePairs, ObeyCoulombsLawFarAwayAndReciprocityEverywhere) {
  const auto [on_box, on_plate] = energies(Eigen::Isometry3d(Eigen::Translation3d(30, 40, 0)));
  EXPECT_NEAR(on_box, of_box.root * of_plate.root / 50, 2e-4 * on_box);
  EXPECT_NEAR(on_box, on_plate, 1e-5 * on_box);
  test::Random random(1);
  for (int i = 0; i < 10; ++i) {
    const Eigen::Isometry3d pose =
        pose_from_axis(random.in_box({-1, -1, -1}, {1, 1, 1}), random.uniform(0, 180),
                       random.in_box({-2, -2, 1.6}, {2, 2, 3}));
    const auto [one, other] = energies(pose);
    EXPECT_NEAR(one, other, 1e-4 * one);
    // Unit energies: by the inequality of Cauchy and Schwarz.
    EXPECT_LT(one, 1);
    EXPECT_GT(one, 0);
  }
}

TEST_F(NodePairs, HaveForcesThatAreDerivatives) {
  const Eigen::Isometry3d pose = pose_from_axis({1, 2, 3}, 30, {0.3, -0.4, 1.8});
  // Two columns of charges p and q: −(p, q) − (q, p) as the box moves.
  const auto rows = [](const PreparedLevel& level) {
    MatrixXf charges = MatrixXf::Zero(level.padded + node_block, 2);
    for (Index k = 0; k < level.count; ++k)
      charges.row(k).setConstant(level.equilibrium[static_cast<std::size_t>(k)]);
    return charges;
  };
  NodePair pair = pair_at(pose);
  const std::vector<Wrench> found = pair.forces(rows(of_box), rows(of_plate));
  ASSERT_EQ(found.size(), 1U);
  constexpr double step = 1e-2;
  for (int coordinate = 0; coordinate < 6; ++coordinate) {
    const Vector3d axis = Vector3d::Unit(coordinate % 3);
    double difference = 0;
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Isometry3d motion = coordinate < 3
                                           ? Eigen::Isometry3d(Eigen::Translation3d(sign * step * axis))
                                           : Eigen::Isometry3d(Eigen::AngleAxisd(sign * step, axis));
      difference += sign * 2 * energies(motion * pose)[0] / (2 * step);
    }
    EXPECT_NEAR(coordinate < 3 ? found[0].force[coordinate] : found[0].torque[coordinate - 3], -difference,
                2e-3)
        << coordinate;
  }
}

TEST(PanelClusters, HoldEveryPanelInItsSphere) {
  std::vector<Panel> panels;
  for (const Triangle& triangle : triangulate(Sphere{1, 12}))
    panels.push_back(make_panel(triangle));
  const PanelClusters found = cluster_panels(panels);
  std::vector<int> times(panels.size());
  for (const PanelCluster& cluster : found.clusters) {
    EXPECT_EQ(cluster.count % node_block, 0);
    for (std::ptrdiff_t place = cluster.first; place < cluster.first + cluster.count; ++place) {
      const std::size_t panel = found.panels[static_cast<std::size_t>(place)];
      if (!found.is_repeated[static_cast<std::size_t>(place)] || times[panel] == 0)
        ++times[panel];
      EXPECT_LE(panels[panel].radius, cluster.panel_radius * (1 + 1e-6));
      for (const Vector3d& corner : panels[panel].corners)
        EXPECT_LE((corner - cluster.centre).norm(), cluster.radius * (1 + 1e-6));
    }
  }
  EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int count) { return count == 1; }));
}

TEST(OutsideCharges, SurroundABodyAndKeepApart) {
  const std::vector<TriangleSurface> cube{{triangulate(Cuboid{2, 2, 2})}};
  const PanelMesh mesh = panels_of(cube);
  const std::vector<OutsideCharge> charges = outside_charges(cube, mesh.panels());
  Vector3d sum = Vector3d::Zero();
  for (const auto& [point, charge] : charges) {
    EXPECT_GT(point.cwiseAbs().maxCoeff(), 1);
    EXPECT_NE(charge, 0);
    sum += point.normalized();
  }
  EXPECT_LT(sum.norm(), 0.3 * static_cast<double>(charges.size()));
  test::Random random(2);
  std::vector<Vector3d> candidates;
  for (int i = 0; i < 300; ++i)
    candidates.push_back(random.in_box({0, 0, 0}, {1, 1, 1}));
  const std::vector<Vector3d> chosen = spread_out(candidates, 0.3, 1000);
  EXPECT_EQ(spread_out(candidates, 0, 5).size(), 5U);
  for (const Vector3d& a : chosen)
    for (const Vector3d& b : chosen)
      EXPECT_TRUE(&a == &b || (a - b).norm() >= 0.3);
  // No candidate is far from all chosen ones.
  for (const Vector3d& candidate : candidates)
    EXPECT_TRUE(std::any_of(chosen.begin(), chosen.end(),
                            [&](const Vector3d& point) { return (point - candidate).norm() < 0.3 + 1e-12; }));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
