/// Tests Maxwell matrices of bodies of triangles against closed forms and against the same bodies with
/// functions on faces, and properties of every Galerkin method.

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bem/panel_system.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using test::at;
using test::object;
using test::per_length;
using test::plate_above_sensor;
using test::sensor;
using test::square;
using testing::HasSubstr;

Mesh mesh_of(const Shape& shape) {
  return {"", 1, triangulate(shape)};
}

/// Returns 20·4^levels triangles with their corners on a sphere, scaled to the volume of the ball of this
/// radius.
Mesh icosphere(double radius, int levels) {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vector3d> corners;
  for (const double one : {-1.0, 1.0})
    for (const double other : {-golden, golden})
      for (const Vector3d& corner :
           {Vector3d(0, one, other), Vector3d(one, other, 0), Vector3d(other, 0, one)})
        corners.push_back(corner.normalized());
  // The faces are the triples of neighbours.
  const auto neighbours = [&](std::size_t a, std::size_t b) {
    return (corners[a] - corners[b]).norm() < 1.06;
  };
  Mesh mesh{"", 1, {}};
  for (std::size_t a = 0; a < corners.size(); ++a)
    for (std::size_t b = a + 1; b < corners.size(); ++b)
      for (std::size_t c = b + 1; c < corners.size(); ++c)
        if (neighbours(a, b) && neighbours(b, c) && neighbours(a, c)) {
          const bool outward = corners[a].dot(corners[b].cross(corners[c])) > 0;
          mesh.triangles.push_back({corners[a], corners[outward ? b : c], corners[outward ? c : b]});
        }
  for (int level = 0; level < levels; ++level) {
    std::vector<Triangle> finer;
    for (const Triangle& triangle : mesh.triangles)
      for (Triangle& quarter : detail::quarters(triangle)) {
        for (Vector3d& corner : quarter)
          corner.normalize();
        finer.push_back(quarter);
      }
    mesh.triangles = finer;
  }
  const double scale = radius * std::cbrt(4 * std::numbers::pi / 3 / signed_volume(mesh.triangles));
  for (Triangle& triangle : mesh.triangles)
    for (Vector3d& corner : triangle)
      corner *= scale;
  return mesh;
}

MaxwellMatrix alone(const Shape& shape, double rtol) {
  Scene scene;
  scene.objects = {object("body", shape, at(0, 0, 0))};
  return maxwell(scene, {.rtol = rtol});
}

bool cover(const MaxwellMatrix& one, const MaxwellMatrix& other) {
  return ((one.values - other.values).array().abs() <= (one.errors + other.errors).array()).all();
}

/// Returns a scene whose box and plate have faces, or with `as_meshes` triangles in their place.
Scene box_beside_plates(bool as_meshes) {
  Scene scene;
  scene.sensors = {sensor("front", {square(0.1, 0)})};
  Eigen::Isometry3d turned = at(0.02, 0.01, 0.05);
  turned.rotate(Eigen::AngleAxisd(0.4, Vector3d(1, 2, 0.5).normalized()));
  const Cuboid box{0.04, 0.06, 0.02};
  const Plate plate{0.08, 0.05};
  scene.objects = {object("box", as_meshes ? Shape(mesh_of(box)) : Shape(box), turned),
                   object("plate", as_meshes ? Shape(mesh_of(plate)) : Shape(plate), at(-0.05, 0, -0.02))};
  return scene;
}

/// C/4πεa of the unit cube (Helsing and Perfekt 2013) and of the square plate.
TEST(BoundaryPanels, BoundTheCubeAndTheSquareFromBelow) {
  for (const auto& [shape, truth] :
       {std::pair(mesh_of(Cuboid{1, 1, 1}), 0.66067815409957), std::pair(mesh_of(Plate{1, 1}), 0.366788)})
    for (const double rtol : {3e-2, 5e-3}) {
      const MaxwellMatrix answer = alone(shape, rtol);
      const double value = per_length(answer.values(0, 0), 1), error = per_length(answer.errors(0, 0), 1);
      EXPECT_TRUE(answer.reached && answer.lower_bounds[0]);
      EXPECT_LT(value, truth);
      EXPECT_LT(truth, value + error);
      EXPECT_LE(error, rtol * value);
    }
}

/// Among plates of equal area the disc has the least capacitance (Pólya and Szegő); 8εR is more than the
/// capacitance of any plate within the disc.
TEST(BoundaryPanels, PutADiscWithinTheBoundsOfPolyaAndSzegoe) {
  constexpr int sides = 24;
  Mesh disc{"", 1, {}};
  const auto corner = [](int k) {
    const double angle = 2 * std::numbers::pi * (k % sides) / sides;
    return Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  for (int k = 0; k < sides; ++k)
    disc.triangles.push_back({Vector3d(0, 0, 0), corner(k), corner(k + 1)});
  const MaxwellMatrix answer = alone(disc, 1e-2);
  const double value = per_length(answer.values(0, 0), 1), error = per_length(answer.errors(0, 0), 1);
  EXPECT_TRUE(answer.reached);
  EXPECT_LT(value, 2 / std::numbers::pi);
  EXPECT_GT(value + error, 2 / std::numbers::pi * std::sqrt(area(disc.triangles) / std::numbers::pi));
}

/// The answer is that of the polyhedron: above the ball of equal volume, below the ball around it.
TEST(BoundaryPanels, PutAPolyhedronBetweenTheBallsOfEqualVolumeAndAroundIt) {
  double before = 0;
  for (const int segments : {6, 12, 24}) {
    const Sphere sphere{1, segments};
    const MaxwellMatrix answer = alone(mesh_of(sphere), 3e-3);
    const double value = per_length(answer.values(0, 0), 1), error = per_length(answer.errors(0, 0), 1);
    EXPECT_TRUE(answer.reached);
    EXPECT_LT(value, 1);
    EXPECT_GT(value + error, std::cbrt(signed_volume(triangulate(sphere)) * 3 / (4 * std::numbers::pi)));
    EXPECT_LT(1 - value, 0.35 * (1 - before)) << "the deficit falls like the square of the segments";
    before = value;
  }
}

/// Spheres of 1 and 2 cm with centres 5 cm apart (Lekner 2011); a sphere above a plane, as a sphere and its
/// image.
TEST(BoundaryPanels, AgreeWithClosedFormsForPairsOfSpheres) {
  Scene scene;
  scene.objects = {object("small", icosphere(0.01, 2), at(0, 0, 0)),
                   object("large", icosphere(0.02, 2), at(0.05, 0, 0))};
  const MaxwellMatrix two = maxwell(scene, {.rtol = 3e-3});
  MatrixXd truth(2, 2);
  truth << 1.2305175015e-12, -0.4945667562e-12, -0.4945667562e-12, 2.4315431141e-12;
  EXPECT_LT(((two.values - truth).array() / truth.array()).abs().maxCoeff(), 4e-3);

  constexpr double gap = 0.5, plane = 1.535370509;
  scene.objects = {object("sphere", icosphere(1, 2), at(0, 0, 0)),
                   object("image", icosphere(1, 2), at(0, 0, 2 + 2 * gap))};
  const MatrixXd images = maxwell(scene, {.rtol = 3e-3}).values;
  EXPECT_NEAR(per_length(images(0, 0) - images(0, 1), 1), plane, 4e-3 * plane);
}

TEST(BoundaryPanels, AgreeWithFunctionsOnFaces) {
  const MaxwellMatrix meshes = maxwell(box_beside_plates(true), {.rtol = 1e-2});
  const MaxwellMatrix faces = maxwell(box_beside_plates(false), {.rtol = 1e-4});
  EXPECT_TRUE(meshes.reached);
  EXPECT_TRUE(cover(meshes, faces));
  EXPECT_NEAR(meshes.delta_self[0], faces.delta_self[0],
              meshes.delta_self_errors[0] + faces.delta_self_errors[0]);
  for (Eigen::Index i = 0; i < 3; ++i)
    EXPECT_LT(meshes.values(i, i), faces.values(i, i) + faces.errors(i, i));
}

TEST(BoundaryPanels, AreReciprocalPositiveDefiniteAndBoundTheirDifference) {
  const MaxwellMatrix coarse = maxwell(box_beside_plates(true), {.rtol = 5e-2});
  const MaxwellMatrix fine = maxwell(box_beside_plates(false), {.rtol = 1e-4});
  EXPECT_EQ(coarse.values, coarse.values.transpose());
  const MatrixXd missing = fine.values + MatrixXd(fine.errors.diagonal().asDiagonal()) - coarse.values;
  EXPECT_EQ(coarse.values.llt().info(), Eigen::Success);
  EXPECT_EQ(missing.llt().info(), Eigen::Success);
}

TEST(BoundaryPanels, DoNotDependOnPlaceAndScale) {
  const double scale = 1000;
  Scene scene, moved;
  scene.sensors = {sensor("front", {square(0.1, 0)})};
  scene.objects = {object("cone", Cone{0.03, 0.05, 7}, at(0.01, 0, 0.06))};
  moved.sensors = {sensor("front", {square(0.1 * scale, 0)})};
  moved.objects = {object("cone", Cone{0.03 * scale, 0.05 * scale, 7}, at(0.01 * scale, 0, 0.06 * scale))};
  Eigen::Isometry3d motion = at(3, -2, 1);
  motion.rotate(Eigen::AngleAxisd(1.1, Vector3d(0.3, -1, 0.4).normalized()));
  moved.links.push_back({"everything", {}, motion});
  moved.sensors[0].link = moved.objects[0].link = 0;
  const MaxwellMatrix round = maxwell(scene, {.rtol = 5e-3}), round_moved = maxwell(moved, {.rtol = 5e-3});
  EXPECT_TRUE(((round_moved.values / scale - round.values).array().abs() <= round.errors.array()).all())
      << "what rounding decides of the quadratures may lead to another mesh";
  for (Scene* const each : {&scene, &moved})
    each->objects[0].shape = Mesh{"", 1, triangulate(each->objects[0].shape)};
  const MaxwellMatrix one = maxwell(scene, {.rtol = 2e-2}), other = maxwell(moved, {.rtol = 2e-2});
  EXPECT_LT(((other.values / scale - one.values).array() / one.values.array()).abs().maxCoeff(), 2e-4);
}

/// The space of finer panels contains that of coarser ones.
TEST(BoundaryPanels, ConvergeFromBelow) {
  const detail::ChargedBodies bodies = detail::charged_bodies(box_beside_plates(true));
  detail::PanelSystem system(bodies);
  Eigen::VectorXd before = Eigen::VectorXd::Zero(3), gain_before;
  for (int level = 0; level < 4; ++level) {
    system.refine({{7, 7}}, 1e-6);
    const detail::PanelSolution solution = system.solve(1e-8);
    EXPECT_GT((solution.all.fine - solution.all.coarse).diagonal().minCoeff(), 0);
    const Eigen::VectorXd gain = solution.all.fine.diagonal() - before;
    EXPECT_GT(gain.minCoeff(), 0);
    if (level > 1) {
      EXPECT_LT(gain.sum(), gain_before.sum());
    }
    gain_before = gain;
    before = solution.all.fine.diagonal();
    system.refine_groups(std::vector<int>(system.mesh().groups().size(), 1), solution.charges);
  }
}

/// A mesh of many triangles is not divided; the stated error contains what the triangles would gain from
/// division.
TEST(BoundaryPanels, TheStatedErrorCoversWhatFinerPanelsFind) {
  Scene scene;
  scene.sensors = {sensor("front", {square(0.1, 0)})};
  scene.objects = {object("ball", icosphere(0.03, 3), at(0, 0, 0.05))};
  const MaxwellMatrix given = maxwell(scene, {.rtol = 1e-2});
  EXPECT_EQ(given.unknowns, 1280U + 25U);
  const detail::ChargedBodies bodies = detail::charged_bodies(scene);
  detail::PanelSystem system(bodies);
  system.refine({{9, 9}}, 1e-4);
  system.refine_groups(std::vector<int>(system.mesh().groups().size(), 1), system.solve(1e-4).charges);
  system.refine({{9, 9}}, 1e-4);
  const MatrixXd finer = 4 * std::numbers::pi * vacuum_permittivity * system.solve(1e-6).all.fine;
  EXPECT_TRUE(((given.values - finer).array().abs() <= given.errors.array()).all());
}

TEST(BoundaryPanels, AFloatingBodyHasNoChargeAndNoRow) {
  Scene scene = box_beside_plates(true), faces = box_beside_plates(false);
  scene.objects[0].role = faces.objects[0].role = Floating{};
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 2e-2});
  EXPECT_EQ(answer.conductors, (std::vector<std::string>{"front", "plate"}));
  EXPECT_TRUE(cover(answer, maxwell(faces, {.rtol = 1e-4})));
}

std::string refusal(const std::function<void(Scene&)>& change, const BoundaryElementOptions& options = {}) {
  return test::refusal(change, [&](const Scene& scene) { maxwell(scene, options); });
}

TEST(BoundaryPanelRefusals, BodiesThatTouchCrossOrHoldEachOther) {
  const auto named = HasSubstr("sensor \"front\" plates[0] and object \"target\" touch or cross");
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].shape = Sphere{0.03, 16}; }), named);
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].shape = Cylinder{0.03, 0.04, 16}; }), named);
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects.push_back(object("other", Sphere{0.02, 12}, at(0.01, 0, 0.05), Floating{}));
                scene.objects[0].shape = Sphere{0.015, 12};
              }),
              HasSubstr("object \"target\" and object \"other\" touch or cross"));
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].shape = Sphere{0.5, 16};
              }),
              HasSubstr("sensor \"front\" plates[0] is inside object \"target\""));
}

TEST(BoundaryPanelRefusals, MeshesWithoutArea) {
  const Triangle flat{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.02, 0, 0)};
  const Triangle needle{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.004, 5e-11, 0)};
  EXPECT_THAT(refusal([&](Scene& scene) {
                scene.objects[0].shape = Mesh{"", 1, {flat, needle}};
              }),
              HasSubstr("object \"target\": no triangle has an area"));
}

TEST(BoundaryPanels, LeaveOutTrianglesWithoutAreaSliversAndDuplicates) {
  const Triangle triangle{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0, 0.01, 0)};
  const Triangle turned{triangle[1], triangle[2], triangle[0]}, back{triangle[1], triangle[0], triangle[2]};
  const Triangle flat{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.02, 0, 0)};
  const Triangle needle{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.004, 5e-13, 0)};
  EXPECT_EQ(detail::cleaned("mesh", std::vector<Triangle>{triangle, flat, turned, needle, back}),
            std::vector<Triangle>{triangle});
}

TEST(BoundaryPanels, WeldCornersThatDifferByRounding) {
  const Triangle one{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const Triangle other{Vector3d(1, 1e-15, 0), Vector3d(1, 1, 0), Vector3d(-1e-15, 1, 0)};
  EXPECT_EQ(detail::cleaned("mesh", std::vector<Triangle>{one, other}),
            (std::vector<Triangle>{one, {one[1], other[1], one[2]}}));
}

TEST(BoundaryPanelRefusals, MoreTrianglesThanUnknowns) {
  EXPECT_THAT(refusal(
                  [](Scene& scene) {
                    scene.objects[0].shape = Sphere{0.01, 48};
                  },
                  {.rtol = 1e-3, .most_unknowns = 2000}),
              HasSubstr("the scene needs at least 2257 unknowns: boundary elements take at most 2000"));
}

TEST(BoundaryPanels, SayWhenTheErrorWasNotReached) {
  Scene scene = plate_above_sensor();
  scene.objects[0].shape = Cone{0.02, 0.02, 8};
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-4, .most_unknowns = 400});
  EXPECT_FALSE(answer.reached);
  EXPECT_LE(answer.unknowns, 400U);
  EXPECT_GT((answer.errors.array() / answer.values.array().abs()).maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
