#include "bem/graded_triangles.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "bem/cluster_tree.hpp"
#include "bem/panel_mesh.hpp"
#include "bem/panel_pair.hpp"
#include "bem/panel_quadrature.hpp"
#include "bem/single_layer_faces.hpp"
#include "bem/single_layer_panels.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "scenes.hpp"

/// Tests the interaction of charged triangles against closed forms, its own sum over finer triangles, which
/// needs other formulas, and what must not matter. Tests the grading of triangles towards sharp edges, before
/// anything is solved for.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

const Triangle base{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0.2, 0.8, 0)};

double element(const Triangle& a, const Triangle& b, double tolerance) {
  const std::array<Panel, 2> panels{make_panel(a), make_panel(b)};
  return single_layer_matrix(panels, tolerance)(0, 1);
}

/// Computes the same element from the 4^levels parts of the first triangle: most of them do not touch the
/// other triangle, and those that do touch it otherwise.
double element_from_parts(const Triangle& a, const Triangle& b, int levels) {
  if (levels == 0)
    return element(a, b, 1e-8);
  double sum = 0;
  for (const Triangle& part : quarters(a))
    sum += element_from_parts(part, b, levels - 1);
  return sum / 4;
}

struct Pair {
  const char* name;
  Triangle other;
};

const std::array<Pair, 13> pairs{
    {{"a common side", {Vector3d(1, 0, 0), Vector3d(0, 0, 0), Vector3d(0.5, -0.3, 0.7)}},
     {"a common side in one plane", {Vector3d(1, 0, 0), Vector3d(0, 0, 0), Vector3d(0.5, -0.7, 0)}},
     {"a common corner", {Vector3d(0, 0, 0), Vector3d(-1, 0, 0.2), Vector3d(-0.5, -0.7, 0)}},
     {"a part of a side", {Vector3d(0.5, 0, 0), Vector3d(0.25, 0, 0), Vector3d(0.3, -0.2, 0)}},
     {"a sliver", {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0.5, -0.02, 0)}},
     {"crossing", {Vector3d(0.3, 0.2, -0.4), Vector3d(0.5, 0.25, 0.5), Vector3d(0.1, 0.6, 0.6)}},
     {"standing on the inside", {Vector3d(0.3, 0.2, 0), Vector3d(0.5, 0.25, 0), Vector3d(0.4, 0.2, 0.6)}},
     {"overlapping in one plane", {Vector3d(0.3, 0.2, 0), Vector3d(1.3, 0.3, 0), Vector3d(0.4, 1.1, 0)}},
     {"overlapping with common lines", {Vector3d(0.5, 0, 0), Vector3d(1.5, 0, 0), Vector3d(0.7, 0.8, 0)}},
     {"inside the other", {Vector3d(0.3, 0.1, 0), Vector3d(0.5, 0.1, 0), Vector3d(0.3, 0.4, 0)}},
     {"close by", {Vector3d(0, 0, 0.01), Vector3d(1, 0, 0.1), Vector3d(0.5, 0.7, 0.2)}},
     {"a size away", {Vector3d(0, 0, 1.5), Vector3d(1, 0, 1.5), Vector3d(0.5, 0.7, 1.8)}},
     {"far away", {Vector3d(0, 0, 8), Vector3d(1, 0, 8), Vector3d(0.5, 0.7, 8.3)}}}};

TEST(PanelElements, AreTheSumsOverParts) {
  for (const auto& [name, other] : pairs) {
    const double truth = element_from_parts(base, other, 2);
    EXPECT_NEAR(element_from_parts(other, base, 2), truth, 1e-6 * truth) << name;
    for (const double tolerance : {1e-2, 1e-4, 1e-6})
      EXPECT_NEAR(element(base, other, tolerance), truth, tolerance * truth) << name;
  }
}

TEST(PointCharges, KeepTheToleranceFromTheDistanceOnFromWhichTheyAreUsed) {
  test::Random random(7);
  for (const double tolerance : {1e-2, 1e-3, 1e-5})
    for (const int degree : far_degrees)
      for (int k = 0; k < 60; ++k) {
        // Triangles of all proportions, slivers among them, just beyond the distance from which the rule is
        // used.
        const auto triangle = [&] {
          const Vector3d a = random.in_box({-1, -1, -1}, {1, 1, 1}),
                         b = random.in_box({-1, -1, -1}, {1, 1, 1});
          const Vector3d off = std::pow(10.0, -k % 3) * random.in_box({-1, -1, -1}, {1, 1, 1});
          return Triangle{a, b, (a + b) / 2 + off};
        };
        const Triangle first = triangle();
        Triangle second = triangle();
        const Panel one = make_panel(first), other = make_panel(second);
        const double distance = 1.001 / far_ratio(tolerance, degree) * (one.radius + other.radius);
        const Vector3d shift =
            one.centre + distance * random.in_box({-1, -1, -1}, {1, 1, 1}).normalized() - other.centre;
        for (Vector3d& corner : second)
          corner += shift;
        const double truth = element(first, second, 1e-9);
        EXPECT_NEAR(element(first, second, tolerance), truth, tolerance * truth)
            << tolerance << " " << degree;
      }
}

// A panel interacts with itself as its quarters do with each other, of charges ¼.
TEST(PanelElements, OfAPanelWithItselfAreThoseOfItsQuarters) {
  test::Random random(1);
  std::vector<Triangle> triangles{base, {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0.7, 1e-3, 0)}};
  while (triangles.size() < 12)
    triangles.push_back(random.triangle_in_box({-1, -1, -1}, {1, 1, 1}));
  for (const Triangle& triangle : triangles) {
    std::vector<Panel> parts;
    for (const Triangle& part : quarters(triangle))
      parts.push_back(make_panel(part));
    const MatrixXd all = single_layer_matrix(parts, 1e-8).selfadjointView<Eigen::Upper>();
    const double self = panel_self(make_panel(triangle));
    EXPECT_NEAR(all.sum() / 16, self, 1e-7 * self);
  }
}

// The mean of 1/r between two points of the unit square is 4·ln(1 + √2) + 4/3·(1 − √2).
TEST(PanelElements, OfTwoHalvesOfASquareMakeUpTheSquare) {
  const double root = std::sqrt(2.0), mean = 4 * std::log(1 + root) + 4.0 / 3 * (1 - root);
  const std::vector<Triangle> halves = test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const double sum = panel_self(make_panel(halves[0])) + panel_self(make_panel(halves[1])) +
                     2 * element(halves[0], halves[1], 1e-8);
  EXPECT_NEAR(sum / 4, mean, 1e-7);
}

Triangle moved(const Triangle& triangle, const Eigen::Isometry3d& pose, double factor = 1) {
  return {factor * (pose * triangle[0]), factor * (pose * triangle[1]), factor * (pose * triangle[2])};
}

TEST(PanelElements, AreSymmetricAndDoNotDependOnWhereBothAre) {
  test::Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Triangle a = random.triangle_in_box({-1, -1, -1}, {1, 1, 1}),
                   b = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Eigen::Isometry3d pose = random.rigid_motion();
    const double found = element(a, b, 1e-6);
    EXPECT_NEAR(element(b, a, 1e-6), found, 1e-5 * found);
    EXPECT_NEAR(element(moved(a, pose), moved(b, pose), 1e-6), found, 1e-5 * found);
    EXPECT_NEAR(element(moved(a, pose, 1e-3), moved(b, pose, 1e-3), 1e-6), 1e3 * found, 1e-2 * found);
    // Two halves of a have half of its charge each.
    const std::array<Triangle, 2> parts = halves(a, longest_side(a));
    EXPECT_NEAR((element(parts[0], b, 1e-6) + element(parts[1], b, 1e-6)) / 2, found, 1e-5 * found);
    EXPECT_LT(found, std::sqrt(panel_self(make_panel(a)) * panel_self(make_panel(b))));
  }
}

/// The mean of a potential over a triangle by a rule that is told how far its singularity is.
TEST(PanelQuadrature, GivesTheMeanOfThePotentialOfACharge) {
  test::Random random(4);
  for (int i = 0; i < 30; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, 0}, {1, 1, 0.2});
    const Vector3d charge = random.in_box({-1, -1, 0.3}, {1, 1, 1});
    const auto distance = [&](const Vector3d& point) { return (point - charge).norm(); };
    const auto mean_of = [&](const Triangle& part, double tolerance) {
      double weights = 0, sum = 0;
      for_each_point(part, tolerance, distance, [&](const Vector3d& point, double weight) {
        weights += weight;
        sum += weight / distance(point);
      });
      EXPECT_NEAR(weights, 1, 1e-12);
      return sum;
    };
    // The expected mean is that over 64 parts, by finer rules.
    std::vector<Triangle> parts{triangle};
    for (int k = 0; k < 3; ++k) {
      std::vector<Triangle> finer;
      for (const Triangle& part : parts)
        for (const Triangle& quarter : quarters(part))
          finer.push_back(quarter);
      parts = finer;
    }
    double expected = 0;
    for (const Triangle& part : parts)
      expected += mean_of(part, 1e-9) / static_cast<double>(parts.size());
    for (const double tolerance : {1e-2, 1e-4, 1e-6})
      EXPECT_NEAR(mean_of(triangle, tolerance), expected, tolerance * expected);
  }
  // Tighter tolerances and lower degrees need greater distances.
  EXPECT_LT(far_ratio(1e-6, 4), far_ratio(1e-3, 4));
  EXPECT_LT(far_ratio(1e-6, 2), far_ratio(1e-6, 4));
}

TEST(PanelQuadrature, AlongASegmentGivesItsLogarithm) {
  const Vector3d from(-1, 0.1, 0), to(1, 0.1, 0);
  const auto distance = [](const Vector3d& a, const Vector3d& b) {
    return segment_distance(Vector3d::Zero(), a, b);
  };
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    double weights = 0, sum = 0;
    for_each_point(from, to, tolerance, distance, [&](const Vector3d& point, double weight) {
      weights += weight;
      sum += weight / point.norm();
    });
    EXPECT_NEAR(weights, 1, 1e-12);
    // Parts of little weight may be less exact.
    EXPECT_NEAR(sum, std::asinh(10.0), 100 * tolerance);
  }
}

TEST(PanelElements, WithAFaceAreThePotentialsMeans) {
  const ChargedFace face{Vector3d(0, 0, 0), Vector3d::UnitX(), Vector3d::UnitY(), 1, 0.6, EdgeKind::thin};
  const std::array<Panel, 1> panel{
      make_panel({Vector3d(-0.3, 0, 0.1), Vector3d(0.9, 0.2, 0.15), Vector3d(0, 0.5, 0.4)})};
  std::vector<Panel> parts{panel[0]};
  for (int level = 0; level < 3; ++level) {
    std::vector<Panel> finer;
    for (const Panel& part : parts)
      for (const Triangle& quarter : quarters(part.corners))
        finer.push_back(make_panel(quarter));
    parts = finer;
  }
  std::vector<Vector3d> centres;
  for (const Panel& part : parts)
    centres.push_back(part.centre);
  const Eigen::VectorXd potentials = face_potentials(face, {5, 5}, centres, 1e-8).rowwise().mean();
  const MatrixXd coupling = single_layer_block(face, {5, 5}, panel, 1e-6);
  // The centres miss the potential's curvature: a 64th of an eighth of it is left.
  EXPECT_LT((coupling.col(0) - potentials).cwiseAbs().maxCoeff(), 2e-3 * potentials.cwiseAbs().maxCoeff());
  const MatrixXd of_parts = single_layer_block(face, {5, 5}, parts, 1e-8).rowwise().mean();
  EXPECT_LT((coupling - of_parts).cwiseAbs().maxCoeff(), 1e-5 * of_parts.cwiseAbs().maxCoeff());
}

TEST(PanelMeshes, KeepTheAreaAndHalveWhereTheDensityChanges) {
  PanelMesh mesh;
  mesh.add(0, std::array<Triangle, 1>{base});
  ASSERT_EQ(mesh.panels().size(), 4U);
  // More charge along the side from the first corner to the second.
  mesh.refine({1}, Eigen::Vector4d(2, 2, 1, 1.5));
  ASSERT_EQ(mesh.groups().size(), 2U);
  ASSERT_EQ(mesh.panels().size(), 8U);
  double area = 0;
  for (const Panel& panel : mesh.panels())
    area += panel.area;
  EXPECT_NEAR(area, twice_area(base) / 2, 1e-15);
  // The first half contains the whole side with more charge.
  EXPECT_EQ(mesh.panels()[0].corners[0], base[1]);
  EXPECT_EQ(mesh.panels()[2].corners[2], base[0]);
  EXPECT_EQ(mesh.places_before(), std::vector<Eigen::Index>(8, PanelMesh::no_place));
}

TEST(PanelMeshes, CarryLinearDensitiesThroughSeveralSteps) {
  PanelMesh mesh;
  mesh.add(0, std::array<Triangle, 1>{base});
  const auto charges = [](const PanelMesh& of) {
    Eigen::MatrixXd result(static_cast<Eigen::Index>(of.panels().size()), 2);
    for (std::size_t k = 0; k < of.panels().size(); ++k) {
      const Panel& panel = of.panels()[k];
      result.row(static_cast<Eigen::Index>(k)) << panel.area,
          panel.area * (2 + 3 * panel.centre.x() - panel.centre.y());
    }
    return result;
  };
  const Eigen::MatrixXd before = charges(mesh);
  const Eigen::MatrixXd carried = mesh.refine({3}, before, before);
  ASSERT_EQ(mesh.panels().size(), 32U);
  EXPECT_LT((carried - charges(mesh)).norm(), 1e-13 * carried.norm());
}

/// The widest angle around the edge of a cube is 270°, around that of a plate 360°.
TEST(EdgeDensity, GrowsTowardsEdgesByTheirAngle) {
  const EdgeDensity cube(triangulate(Cuboid{1, 1, 1})), plate(triangulate(Plate{1, 1}));
  ASSERT_EQ(cube.edges_around(0).size(), 4U) << "those of the face, not its diagonal";
  ASSERT_EQ(plate.edges_around(0).size(), 4U);
  for (const detail::SharpEdge& edge : cube.edges_around(0))
    EXPECT_NEAR(edge.exponent, 1.0 / 3, 1e-12);
  for (const detail::SharpEdge& edge : plate.edges_around(1))
    EXPECT_NEAR(edge.exponent, 1.0 / 2, 1e-12);
  const double near = plate.at(0, Vector3d(0, 0.5 - 1e-6, 0)),
               nearer = plate.at(0, Vector3d(0, 0.5 - 1e-8, 0));
  EXPECT_NEAR(nearer / near, 10, 0.01);
}

TEST(EdgeDensity, DoesNotGrowIntoAHollow) {
  const std::vector<Triangle> triangles = test::angle_iron(2, 2, 1);
  ASSERT_TRUE(is_closed(triangles));
  const EdgeDensity density(triangles);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const Vector3d normal = (triangles[k][1] - triangles[k][0]).cross(triangles[k][2] - triangles[k][0]);
    const Vector3d middle = (triangles[k][0] + triangles[k][1] + triangles[k][2]) / 3;
    const bool in_hollow = normal.z() == 0 && middle.x() >= 1 && middle.y() >= 1;
    EXPECT_EQ(density.edges_around(k).size(), in_hollow ? 3U : normal.z() == 0 ? 4U : 6U) << k;
  }
}

TEST(EdgeDensity, DoesNotGrowTowardsTheFacetsOfABall) {
  EXPECT_TRUE(EdgeDensity(triangulate(Sphere{1, 48})).edges_around(1000).empty());
}

TEST(GradedTriangles, CoverTheSurfaceAndGrowInNumber) {
  const std::vector<Triangle> cube = triangulate(Cuboid{1, 2, 0.5});
  std::size_t before = 0;
  for (const double missing : {1e-2, 1e-3, 3e-4}) {
    const std::vector<Triangle> graded = detail::graded_triangles(cube, missing, 2000);
    EXPECT_NEAR(area(graded), area(cube), 1e-12);
    EXPECT_GT(graded.size(), before);
    before = graded.size();
  }
  EXPECT_LT(detail::graded_triangles(cube, 1e-6, 100).size(), 200U);
}

TEST(GradedTriangles, OfACubeAreEnoughForAnAccurateAnswer) {
  Scene scene;
  scene.objects = {test::object("cube", Mesh{"", 1, triangulate(Cuboid{1, 1, 1})}, test::at(0, 0, 0))};
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 2e-3});
  EXPECT_TRUE(answer.reached);
  EXPECT_LT(answer.unknowns, 3000U);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
