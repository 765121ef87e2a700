/// Tests the reduced method with bodies of triangles against boundary elements, and against the same bodies
/// with functions on their faces.

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "random_poses.hpp"
#include "reduced/body_gap.hpp"
#include "reduced/prepared_mesh.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scenes.hpp"
#include "surface/panel.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using test::at;
using test::covers;
using test::object;
using test::per_length;
using test::Random;
using test::sensor;
using test::square;
using testing::HasSubstr;

/// Returns the triangles of a shape, each quartered so many times.
Mesh mesh_of(const Shape& shape, int quarterings = 0) {
  Mesh mesh{"", 1, triangulate(shape)};
  for (; quarterings > 0; --quarterings) {
    std::vector<Triangle> finer;
    for (const Triangle& triangle : mesh.triangles)
      for (const Triangle& quarter : detail::quarters(triangle))
        finer.push_back(quarter);
    mesh.triangles = finer;
  }
  return mesh;
}

Scene above_sensor(const Shape& shape, const Isometry3d& pose) {
  Scene scene;
  scene.links = {{"arm", {}, pose}};
  scene.sensors = {sensor("front", {square(0.1, 0)})};
  scene.objects = {object("target", shape, at(0, 0, 0))};
  scene.objects[0].link = 0;
  return scene;
}

/// Options for which few triangles suffice, so that bodies are prepared quickly.
const ReducedOptions loose{.rtol = 0.1};

TEST(ReducedMeshes, ALoneCubeIsTheCubesCapacitance) {
  Scene scene;
  scene.objects = {object("cube", mesh_of(Cuboid{0.02, 0.02, 0.02}), at(1, 2, 3))};
  const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-2});
  // C/4πεa of the cube (Helsing and Perfekt 2013).
  constexpr double truth = 0.66067815409957;
  EXPECT_NEAR(per_length(answer.values(0, 0), 0.02), truth, per_length(answer.errors(0, 0), 0.02));
  EXPECT_NEAR(per_length(answer.values(0, 0), 0.02), truth, 1e-3 * truth);
  EXPECT_TRUE(answer.reached);
}

TEST(ReducedMeshesAtLength, TheStatedErrorCoversThatOfABoxInRandomPoses) {
  constexpr int count = 12;
  const Cuboid box{0.06, 0.04, 0.02};
  Random random(1);
  int answered = 0, covered = 0, reached = 0;
  ReducedEvaluator evaluator(above_sensor(mesh_of(box), at(0, 0, 1)), {.rtol = 1e-2});
  for (int k = 0; k < count; ++k) {
    const Isometry3d pose =
        test::turned_at(random.in_box({-0.08, -0.08, 0.015}, {0.08, 0.08, 0.065}), random);
    MaxwellMatrix truth;
    try {
      truth = maxwell(above_sensor(box, pose), {.rtol = 1e-3});
    } catch (const InputError&) {
      continue;
    }
    evaluator.set_pose("arm", pose);
    const MaxwellMatrix& answer = evaluator.maxwell();
    ++answered;
    covered += covers(answer, truth);
    if (!answer.reached)
      continue;
    ++reached;
    EXPECT_TRUE(((answer.values - truth.values).array().abs() <=
                 truth.errors.array() + 1e-2 * truth.values.array().abs())
                    .all())
        << k;
  }
  EXPECT_GT(answered, count / 2);
  EXPECT_GE(covered, 0.99 * answered);
  EXPECT_GE(reached, 0.7 * answered) << "an honest answer that is none is of little use";

  // Near contact the answer is right, or says that the accuracy was not reached.
  for (const double gap : {4e-3, 1e-3, 1e-4, 1e-6}) {
    const Isometry3d pose = at(0, 0, 0.01 + gap);
    evaluator.set_pose("arm", pose);
    const MaxwellMatrix& answer = evaluator.maxwell();
    if (gap >= 1e-3)
      EXPECT_TRUE(covers(answer, maxwell(above_sensor(box, pose), {.rtol = 1e-3}))) << gap;
    else
      EXPECT_FALSE(answer.reached) << gap;
  }
}

TEST(ReducedMeshes, TheStatedErrorContainsTheFacetsOfBalls) {
  // Series of images (Lekner 2011): balls of 1 and 2 cm, 5 cm apart, in pF.
  const Eigen::Matrix2d exact{{1.2305175015, -0.4945667562}, {-0.4945667562, 2.4315431141}};
  Scene scene;
  scene.objects = {object("small", Sphere{0.01, 16}, at(0, 0, 0), Electrode{}),
                   object("large", Sphere{0.02, 16}, at(0.05, 0, 0), Electrode{})};
  ReducedEvaluator evaluator(scene, loose);
  const MaxwellMatrix& found = evaluator.maxwell();
  for (Eigen::Index row = 0; row < 2; ++row)
    for (Eigen::Index column = 0; column < 2; ++column)
      EXPECT_NEAR(1e12 * found.values(row, column), exact(row, column), 1e12 * found.errors(row, column));
  EXPECT_LE(found.errors(0, 0), 0.06 * found.values(0, 0));
}

TEST(ReducedMeshesAtLength, SeveralBodiesTogether) {
  Scene scene = above_sensor(Sphere{0.02, 12}, at(-0.02, 0, 0.035));
  scene.objects.push_back(object("cylinder", Cylinder{0.015, 0.05, 12}, at(0.05, 0.01, 0.05)));
  scene.objects.push_back(object("box", Cuboid{0.03, 0.04, 0.02}, at(0, 0.07, 0.04), Floating{}));
  const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-2});
  const MaxwellMatrix truth = maxwell(scene, {.rtol = 1e-2});
  EXPECT_EQ(answer.conductors, truth.conductors);
  EXPECT_TRUE(covers(answer, truth));
  EXPECT_TRUE((answer.errors.diagonal().array() < 0.1 * answer.values.diagonal().array()).all());
  EXPECT_LT((answer.values - answer.values.transpose()).cwiseAbs().maxCoeff(), 1e-12 * answer.values.norm());
}

TEST(ReducedMeshes, ASheetIsThePlateItStandsFor) {
  const Isometry3d pose = pose_from_axis({1, 0.5, 0}, 30, {0.02, 0, 0.06});
  const MaxwellMatrix sheet =
      reduced_capacitance(above_sensor(mesh_of(Plate{0.08, 0.06}), pose), {.rtol = 0.03});
  EXPECT_TRUE(sheet.reached);
  EXPECT_TRUE(covers(sheet, maxwell(above_sensor(Plate{0.08, 0.06}, pose), {.rtol = 1e-4})));
}

TEST(ReducedMeshes, DependOnlyOnProportionsAndRelativePoses) {
  const Shape shape = mesh_of(Cylinder{0.02, 0.04, 10});
  const MaxwellMatrix answer = reduced_capacitance(above_sensor(shape, at(0, 0.01, 0.05)), loose);

  Scene larger = above_sensor(shape, at(0, 0.02, 0.1));
  larger.sensors = {sensor("front", {square(0.2, 0)})};
  for (Triangle& triangle : std::get<Mesh>(larger.objects[0].shape).triangles)
    for (Vector3d& corner : triangle)
      corner *= 2;
  EXPECT_LT((reduced_capacitance(larger, loose).values - 2 * answer.values).norm(),
            1e-5 * answer.values.norm());

  Scene moved = above_sensor(shape, at(0, 0.01, 0.05));
  const Isometry3d motion = pose_from_axis({1, 2, 3}, 70, {0.5, 2, -1});
  moved.links.push_back({"all", {}, motion});
  moved.links[0].parent = 1;
  moved.sensors[0].link = 1;
  EXPECT_LT((reduced_capacitance(moved, loose).values - answer.values).norm(), 1e-5 * answer.values.norm());
}

TEST(ReducedMeshes, AMovedLinkGivesWhatASceneThereGives) {
  const Shape shape = Sphere{0.02, 10};
  ReducedEvaluator evaluator(above_sensor(shape, at(0, 0, 0.2)), loose);
  for (const double height : {0.05, 0.03, 0.1}) {
    evaluator.set_pose("arm", at(0.01, 0, height));
    EXPECT_EQ(evaluator.maxwell().values,
              reduced_capacitance(above_sensor(shape, at(0.01, 0, height)), loose).values);
  }
}

TEST(ReducedMeshes, ContactsAreRefusedAndForgotten) {
  ReducedEvaluator evaluator(above_sensor(Sphere{0.02, 10}, at(0, 0, 0.05)), loose);
  const MatrixXd before = evaluator.maxwell().values;
  evaluator.set_pose("arm", at(0, 0, 0.01));
  try {
    evaluator.maxwell();
    ADD_FAILURE() << "the sphere crosses the plate";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("sensor \"front\" plates[0] and object \"target\" touch or cross"));
  }
  evaluator.set_pose("arm", at(0, 0, 0.05));
  EXPECT_EQ(evaluator.maxwell().values, before);

  Scene holding = above_sensor(mesh_of(Cuboid{0.2, 0.2, 0.2}), at(0, 0, 0));
  EXPECT_THROW(reduced_capacitance(holding, loose), InputError) << "the plate is inside the box";
}

TEST(ReducedMeshes, TheGapIsNoMoreThanTheDistance) {
  using detail::PlacedBody;
  const detail::PreparedShape ball({{mesh_of(Sphere{1, 10}).triangles}}, 0.02);
  const detail::PreparedShape plate(detail::plate_at_origin(1, 1));
  Random random(3);
  int known = 0;
  for (int k = 0; k < 200; ++k) {
    const Isometry3d pose = test::turned_at(random.in_box({-2, -2, -2}, {2, 2, 2}), random),
                     back = pose.inverse();
    double distance = 1e9;
    for (const Triangle& triangle : ball.mesh()->surfaces()[0].triangles)
      for (const Vector3d& corner : triangle)
        distance = std::min(distance, ((back * corner).cwiseAbs() - Vector3d(1, 1, 0)).cwiseMax(0).norm());
    const double gap = detail::body_gap(PlacedBody{&ball, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()},
                                        PlacedBody{&plate, 1, pose.translation(), pose.linear()});
    EXPECT_LE(gap, distance + 1e-9) << k;
    known += gap > 0;
  }
  EXPECT_GT(known, 60);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
