/// Tests the grading of triangles towards sharp edges, before anything is solved for.

#include "bem/graded_triangles.hpp"

#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::EdgeDensity;
using Eigen::Vector3d;

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

/// C/4πεa of the unit cube (Helsing and Perfekt 2013).
TEST(GradedTriangles, OfACubeAnswerAsItsFacesDo) {
  const Mesh mesh{"", 1, triangulate(Cuboid{1, 1, 1})};
  Scene scene;
  scene.objects = {test::object("cube", mesh, test::at(0, 0, 0))};
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 2e-3});
  const double value = test::per_length(answer.values(0, 0), 1),
               error = test::per_length(answer.errors(0, 0), 1);
  EXPECT_TRUE(answer.reached);
  EXPECT_LT(value, 0.66067815409957);
  EXPECT_GT(value + error, 0.66067815409957);
  EXPECT_LT(answer.unknowns, 3000U);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
