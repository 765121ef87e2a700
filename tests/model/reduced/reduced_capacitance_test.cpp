#include "reduced/reduced_capacitance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "reduced/body_gap.hpp"
#include "reduced/prepared_mesh.hpp"
#include "scenes.hpp"

/// Tests the reduced method against the boundary elements that it reduces, where something moves, is near or
/// far, or consists of triangles. What holds of every matrix is in
/// tests/model/scene/matrices_by_method_test.cpp.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using namespace test;

/// Options for which few triangles suffice, so that bodies are prepared quickly.
const ReducedOptions loose{.rtol = 0.1};

Scene plate_above_sensor(double gap) {
  Scene scene = test::plate_above_sensor();
  scene.objects[0].pose = at(0, 0, gap);
  return scene;
}

/// Returns a target on the link "arm", above a sensor of 10 cm.
Scene on_arm(const Shape& shape, const Isometry3d& pose) {
  Scene scene = plate_above_sensor(0);
  scene.links = {{"arm", {}, pose}};
  scene.objects[0].shape = shape;
  scene.objects[0].link = 0;
  return scene;
}

/// Returns a pose at a point, turned by up to half a turn about a nearly horizontal axis.
Eigen::Isometry3d turned_at(const Eigen::Vector3d& point, Random& random) {
  const double angle = random.uniform(0, 3);
  Eigen::Isometry3d pose(Eigen::Translation3d{point});
  pose.rotate(Eigen::AngleAxisd(angle, random.in_box({-1, -1, 0.3}, {1, 1, 0.3}).normalized()));
  return pose;
}

/// Expects the answers to be those of scenes whose first link is there, also after a contact.
void expect_to_follow(Scene scene, const ReducedOptions& options, const std::vector<Isometry3d>& poses,
                      const Isometry3d& in_contact) {
  const Link start = scene.links[0];
  SCOPED_TRACE(start.name);
  ReducedEvaluator evaluator(scene, options);
  const Eigen::MatrixXd before = evaluator.maxwell().values;
  for (const Isometry3d& pose : poses) {
    scene.links[0].pose = pose;
    evaluator.set_pose(start.name, pose);
    EXPECT_EQ(evaluator.maxwell().values, reduced_capacitance(scene, options).values);
  }
  evaluator.set_pose(start.name, in_contact);
  EXPECT_THROW(evaluator.maxwell(), InputError);
  evaluator.set_pose(start.name, start.pose);
  EXPECT_EQ(evaluator.maxwell().values, before);
  EXPECT_EQ(evaluator.maxwell().values, before) << "nothing moved";
  EXPECT_THROW(evaluator.set_pose("nobody", in_contact), InputError);
}

TEST(Reduced, FollowsALinkAsASceneThereAndForgetsContacts) {
  expect_to_follow(hand_above_sensors(), {.rtol = 1e-3},
                   {at(0.01, 0, 0.03), at(0.01, 0, 0), at(0.01, 0, 0.1)}, at(0, 0, -0.05));
  expect_to_follow(on_arm(Sphere{0.02, 10}, at(0, 0, 0.2)), loose, {at(0.01, 0, 0.05), at(0.01, 0, 0.03)},
                   at(0, 0, 0.01));
  // A sensor that moves before two bodies that touch.
  Scene joined = above_sensor(foot_and_leg());
  joined.links = {{"sensor", {}, at(0, 0, 0)}};
  joined.sensors[0].link = 0;
  expect_to_follow(joined, loose, {pose_from_axis({1, 1, 0}, 20, {0.01, 0, -0.01})}, at(0.01, 0.01, 0.02));
}

/// In single precision, the difference of numbers that agree to eight digits would be lost.
TEST(Reduced, DeltaSelfOfAFarObject) {
  for (const double distance : {1.0, 10.0, 100.0}) {
    const MaxwellMatrix truth = maxwell(plate_above_sensor(distance), {.rtol = 1e-4});
    const MaxwellMatrix answer = reduced_capacitance(plate_above_sensor(distance), {.rtol = 1e-3});
    EXPECT_NEAR(answer.delta_self[0], truth.delta_self[0], 1e-3 * truth.delta_self[0]);
    EXPECT_NEAR(answer.values(0, 1), truth.values(0, 1), 1e-3 * std::abs(truth.values(0, 1)));
  }
}

TEST(Reduced, IsAccurateNearContactOrSaysThatItIsNot) {
  for (const double gap : {1e-2, 4e-3, 2e-3})
    for (const double rtol : {1e-2, 1e-3}) {
      const MaxwellMatrix answer = reduced_capacitance(plate_above_sensor(gap), {.rtol = rtol});
      EXPECT_TRUE(covers(answer, maxwell(plate_above_sensor(gap), {.rtol = 1e-3}))) << gap;
    }
  // The two-terminal capacitance is more than that of the field between the plates alone, which the answers
  // at these gaps miss.
  for (const double gap : {4e-4, 1e-4, 1e-6, 1e-18})
    for (const double size : {0.1, 0.02}) {
      Scene scene = plate_above_sensor(gap);
      scene.objects[0].shape = Plate{size, size};
      const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-3});
      EXPECT_FALSE(answer.reached) << gap;
      EXPECT_GT(answer.delta_self[0] + answer.delta_self_errors[0], vacuum_permittivity * size * size / gap)
          << gap;
    }
}

TEST(Reduced, StatesNoFiniteErrorForAChargeNarrowerThanItsFunctions) {
  Scene scene = plate_above_sensor(0.01);
  const Shape wall = Plate{4, 4};
  for (const Shape& shape : {Shape(Plate{2, 2}), wall, Shape(Mesh{"", 1, triangulate(wall)})}) {
    scene.objects[0].shape = shape;
    const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 0.1});
    EXPECT_FALSE(answer.reached);
    EXPECT_TRUE((answer.errors.array() == std::numeric_limits<double>::infinity()).all());
  }
  scene.objects[0].shape = Plate{0.5, 0.5};
  EXPECT_TRUE(covers(reduced_capacitance(scene, {.rtol = 1e-3}), maxwell(scene, {.rtol = 1e-2})));
}

/// Draws poses of a plate or a box of 1 to 30 cm near a sensor of 10 cm, sometimes almost touching it.
class RandomTarget {
 public:
  explicit RandomTarget(unsigned seed) : random_(seed) {
    const auto size = [this] { return 0.01 * std::pow(30, random_.uniform(0, 1)); };
    const bool box = seed % 4 == 0;
    const Cuboid cuboid{size(), size(), size()};
    thickness_ = box ? cuboid.size_z : 0;
    scene_.links = {{"arm", {}, Eigen::Isometry3d::Identity()}};
    scene_.sensors = {sensor("front", {square(0.1, 0)})};
    const Shape shape = box ? Shape(cuboid) : Plate{cuboid.size_x, cuboid.size_y};
    scene_.objects = {on_link(0, object("target", shape, at(0, 0, 0)))};
  }

  /// Returns the scene in its next pose.
  const Scene& next() {
    double height = 0.005 * std::pow(30, random_.uniform(0, 1));
    const bool parallel = random_.uniform(0, 1) < 0.4;
    if (parallel)
      height += thickness_ / 2;
    const Vector3d place = random_.in_box({-0.12, -0.12, height}, {0.12, 0.12, height});
    scene_.links[0].pose =
        parallel ? Eigen::Isometry3d(Eigen::Translation3d(place)) : turned_at(place, random_);
    return scene_;
  }

 private:
  Random random_;
  double thickness_ = 0;
  Scene scene_;
};

/// Counts answers that are right, and those that are useful.
struct Comparison {
  void add(const MaxwellMatrix& answer, const MaxwellMatrix& truth, double rtol) {
    ++answered;
    covered += covers(answer, truth);
    if (!answer.reached)
      return;
    ++reached;
    EXPECT_TRUE(((answer.values - truth.values).array().abs() <=
                 truth.errors.array() + rtol * truth.values.array().abs())
                    .all());
  }
  void expect(int at_least, double share_reached) const {
    EXPECT_GT(answered, at_least);
    EXPECT_GE(covered, 0.99 * answered);
    EXPECT_GE(reached, share_reached * answered) << "an honest answer that is none is of little use";
  }

  int answered = 0, covered = 0, reached = 0;
};

/// Returns the truth, if the pose is not in contact.
std::optional<MaxwellMatrix> truth_of(const Scene& scene, const BoundaryElementOptions& options) {
  try {
    return maxwell(scene, options);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

TEST(ReducedAtLength, TheStatedErrorCoversNinetyNinePerCentOfRandomPoses) {
  constexpr std::array<double, 2> rtols{1e-2, 1e-3};
  std::array<Comparison, 2> comparisons;
  for (unsigned target = 1; target <= 8; ++target) {
    RandomTarget poses(target);
    std::array<ReducedEvaluator, 2> evaluators{ReducedEvaluator(poses.next(), {.rtol = rtols[0]}),
                                               ReducedEvaluator(poses.next(), {.rtol = rtols[1]})};
    for (int pose = 0; pose < 25; ++pose) {
      const Scene& scene = poses.next();
      // With more unknowns, the truth for one of the poses takes as long as for all others.
      const auto truth = truth_of(scene, {.rtol = 1e-3, .most_unknowns = 2000});
      if (!truth)
        continue;
      for (std::size_t k = 0; k < 2; ++k) {
        evaluators[k].set_pose("arm", scene.links[0].pose);
        comparisons[k].add(evaluators[k].maxwell(), *truth, rtols[k]);
      }
    }
  }
  for (const Comparison& each : comparisons)
    each.expect(150, 0.8);
}

TEST(ReducedMeshesAtLength, TheStatedErrorCoversThatOfABoxInRandomPoses) {
  constexpr int count = 12;
  const Cuboid box{0.06, 0.04, 0.02};
  Random random(1);
  Comparison comparison;
  ReducedEvaluator evaluator(on_arm(Mesh{"", 1, triangulate(box)}, at(0, 0, 1)), {.rtol = 1e-2});
  for (int k = 0; k < count; ++k) {
    const Isometry3d pose = turned_at(random.in_box({-0.08, -0.08, 0.015}, {0.08, 0.08, 0.065}), random);
    const auto truth = truth_of(on_arm(box, pose), {.rtol = 1e-3});
    if (!truth)
      continue;
    evaluator.set_pose("arm", pose);
    comparison.add(evaluator.maxwell(), *truth, 1e-2);
  }
  comparison.expect(count / 2, 0.7);

  // Near contact the answer is right, or says that the accuracy was not reached.
  for (const double gap : {4e-3, 1e-3, 1e-4, 1e-6}) {
    const Isometry3d pose = at(0, 0, 0.01 + gap);
    evaluator.set_pose("arm", pose);
    const MaxwellMatrix& answer = evaluator.maxwell();
    if (gap >= 1e-3)
      EXPECT_TRUE(covers(answer, maxwell(on_arm(box, pose), {.rtol = 1e-3}))) << gap;
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
  Scene scene = on_arm(Sphere{0.02, 12}, at(-0.02, 0, 0.035));
  scene.objects.push_back(object("cylinder", Cylinder{0.015, 0.05, 12}, at(0.05, 0.01, 0.05)));
  scene.objects.push_back(object("box", Cuboid{0.03, 0.04, 0.02}, at(0, 0.07, 0.04), Floating{}));
  const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-2});
  const MaxwellMatrix truth = maxwell(scene, {.rtol = 1e-2});
  EXPECT_EQ(answer.conductors, truth.conductors);
  EXPECT_TRUE(covers(answer, truth));
  EXPECT_TRUE((answer.errors.diagonal().array() < 0.1 * answer.values.diagonal().array()).all());
  EXPECT_LT((answer.values - answer.values.transpose()).cwiseAbs().maxCoeff(), 1e-12 * answer.values.norm());
}

TEST(ReducedMeshes, TheGapIsNoMoreThanTheDistance) {
  using detail::PlacedBody;
  const detail::PreparedShape ball({{triangulate(Sphere{1, 10})}}, 0.02);
  const detail::PreparedShape plate(detail::plate_at_origin(1, 1));
  Random random(3);
  int known = 0;
  for (int k = 0; k < 200; ++k) {
    const Isometry3d pose = turned_at(random.in_box({-2, -2, -2}, {2, 2, 2}), random), back = pose.inverse();
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
