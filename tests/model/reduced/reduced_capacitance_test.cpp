#include "reduced/reduced_capacitance.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "random_poses.hpp"
#include "scenes.hpp"

/// Tests the reduced method against the boundary elements that it reduces, and properties of every
/// answer; and that invalid input is refused with the element and the reason.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using test::at;
using test::covers;
using test::object;
using test::per_length;
using test::Random;
using test::sensor;
using test::square;
using test::turned_at;

/// Relative error that single precision leaves in an invariance.
constexpr double rounding = 1e-5;

double relative_difference(const MatrixXd& a, const MatrixXd& b) {
  return ((a - b).array() / b.array()).abs().maxCoeff();
}

/// Returns a scene of a sensor of one plate, a sensor of two plates, a box on the link "hand" and a fixed
/// plate.
Scene hand_above_sensors() {
  Scene scene;
  scene.links = {{"hand", {}, Eigen::Isometry3d::Identity()}};
  scene.sensors = {sensor("left", {{{-0.06, -0.05, 0}, {0.05, 0, 0}, {0, 0.1, 0}}}),
                   sensor("right", {{{0.01, -0.05, 0}, {0.05, 0, 0}, {0, 0.04, 0}},
                                    {{0.01, 0.01, 0}, {0.05, 0, 0}, {0, 0.04, 0}}})};
  Eigen::Isometry3d turned = at(0.02, 0.01, 0.05);
  turned.rotate(Eigen::AngleAxisd(0.4, Vector3d(1, 2, 0.5).normalized()));
  scene.objects = {object("box", Cuboid{0.04, 0.06, 0.02}, turned),
                   object("plate", Plate{0.08, 0.05}, at(-0.05, 0, -0.02))};
  scene.objects[0].link = 0;
  return scene;
}

Scene plate_above_sensor(double gap) {
  Scene scene;
  scene.sensors = {sensor("front", {square(0.1, 0)})};
  scene.objects = {object("target", Plate{0.1, 0.1}, at(0, 0, gap))};
  return scene;
}

TEST(Reduced, AgreesWithBoundaryElements) {
  const MaxwellMatrix truth = maxwell(hand_above_sensors(), {.rtol = 1e-4});
  for (const double rtol : {1e-2, 1e-3, 3e-4}) {
    const ReducedOptions options{.rtol = rtol};
    const MaxwellMatrix answer = reduced_capacitance(hand_above_sensors(), options);
    EXPECT_EQ(answer.conductors, truth.conductors);
    EXPECT_TRUE(answer.reached);
    EXPECT_TRUE(covers(answer, truth));
    EXPECT_LT(relative_difference(answer.values, truth.values), rtol);
    EXPECT_LT(relative_difference(answer.delta_self, truth.delta_self), rtol);
  }
}

/// C/4πεa of the square plate and of the cube (BOUNDARY_ELEMENTS.md, section 7).
TEST(Reduced, GivesTheCapacitanceOfABodyAlone) {
  Scene plate, cube;
  plate.sensors = {sensor("plate", {square(0.1, 0)})};
  cube.objects = {object("cube", Cuboid{2, 2, 2}, at(0.3, 0, 0))};
  for (const auto& [scene, length, truth] :
       {std::tuple(plate, 0.1, 0.366788), std::tuple(cube, 2.0, 0.66067815)}) {
    const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 3e-4});
    const double error = per_length(answer.errors(0, 0), length);
    EXPECT_TRUE(answer.reached);
    EXPECT_NEAR(per_length(answer.values(0, 0), length), truth, error);
    EXPECT_LT(error, 3e-4 * truth);
  }
}

TEST(Reduced, ExactlyReciprocalAndPositiveDefinite) {
  const MaxwellMatrix answer = reduced_capacitance(hand_above_sensors(), {.rtol = 1e-3});
  EXPECT_LT(relative_difference(answer.values, answer.values.transpose()), 1e-14);
  EXPECT_EQ(answer.values.llt().info(), Eigen::Success);
  EXPECT_FALSE(answer.lower_bounds[0]);
}

TEST(Reduced, InvariantUnderRigidMotion) {
  const Scene scene = hand_above_sensors();
  Scene turned = scene;
  Eigen::Isometry3d motion = at(0.3, -0.2, 0.1);
  motion.rotate(Eigen::AngleAxisd(1.1, Vector3d(0.3, -1, 0.4).normalized()));
  turned.links.push_back({"everything", {}, motion});
  turned.links[0].parent = 1;
  for (Sensor& sensor : turned.sensors)
    sensor.link = 1;
  turned.objects[1].link = 1;
  EXPECT_LT(relative_difference(reduced_capacitance(turned, {.rtol = 1e-3}).values,
                                reduced_capacitance(scene, {.rtol = 1e-3}).values),
            rounding);
}

TEST(Reduced, GrowsWithTheScale) {
  const auto scaled = [](double scale) {
    Scene scene;
    scene.sensors = {sensor("front", {square(scale, 0)})};
    scene.objects = {
        object("box", Cuboid{0.5 * scale, 0.7 * scale, 0.2 * scale}, at(0.2 * scale, 0, 0.5 * scale))};
    return reduced_capacitance(scene, {.rtol = 1e-3}).values;
  };
  const MatrixXd one = scaled(1);
  EXPECT_EQ(scaled(0x1p-20), 0x1p-20 * one);
  for (const double scale : {1e-6, 1e4})
    EXPECT_LT(relative_difference(scaled(scale), scale * one), rounding);
}

TEST(Reduced, GrowsWithThePermittivity) {
  Scene scene = plate_above_sensor(0.02);
  const MatrixXd vacuum = reduced_capacitance(scene, {.rtol = 1e-3}).values;
  scene.medium.relative_permittivity = 3;
  EXPECT_LT(relative_difference(reduced_capacitance(scene, {.rtol = 1e-3}).values, 3 * vacuum), 1e-14);
}

TEST(Reduced, ExchangingTheConductorsExchangesTheEntries) {
  const Scene scene = hand_above_sensors();
  Scene exchanged = scene;
  std::swap(exchanged.sensors[0], exchanged.sensors[1]);
  std::swap(exchanged.objects[0], exchanged.objects[1]);
  Eigen::PermutationMatrix<4> order;
  order.indices() << 1, 0, 3, 2;
  const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-3}),
                      other = reduced_capacitance(exchanged, {.rtol = 1e-3});
  const MatrixXd permuted = order * other.values * order;
  EXPECT_LT(relative_difference(permuted, answer.values), 1e-4);
}

TEST(Reduced, AMovedLinkGivesWhatASceneThereGives) {
  Scene scene = hand_above_sensors();
  ReducedEvaluator evaluator(scene, {.rtol = 1e-3});
  evaluator.maxwell();
  for (const double height : {0.03, 0.0, 0.1}) {
    scene.links[0].pose = at(0.01, 0, height);
    evaluator.set_pose("hand", scene.links[0].pose);
    EXPECT_EQ(evaluator.maxwell().values, reduced_capacitance(scene, {.rtol = 1e-3}).values);
  }
  EXPECT_EQ(evaluator.maxwell().values, reduced_capacitance(scene, {.rtol = 1e-3}).values) << "nothing moved";
  EXPECT_THROW(evaluator.set_pose("nobody", at(0, 0, 0)), InputError);
}

TEST(Reduced, AContactThatIsLeftAgainIsForgotten) {
  Scene scene = hand_above_sensors();
  ReducedEvaluator evaluator(scene, {.rtol = 1e-3});
  const MatrixXd before = evaluator.maxwell().values;
  evaluator.set_pose("hand", at(0, 0, -0.05));
  EXPECT_THROW(evaluator.maxwell(), InputError);
  evaluator.set_pose("hand", at(0, 0, 0));
  EXPECT_EQ(evaluator.maxwell().values, before);
}

TEST(Reduced, AFloatingObjectHasNoChargeAndNoRow) {
  Scene scene = hand_above_sensors();
  scene.objects[0].role = Floating{};
  const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-3}),
                      truth = maxwell(scene, {.rtol = 1e-4});
  EXPECT_EQ(answer.conductors, truth.conductors);
  EXPECT_EQ(answer.floating, truth.floating);
  EXPECT_TRUE(answer.reached && covers(answer, truth));
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
    scene_.objects = {
        object("target", box ? Shape(cuboid) : Shape(Plate{cuboid.size_x, cuboid.size_y}), at(0, 0, 0))};
    scene_.objects[0].link = 0;
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

TEST(ReducedAtLength, TheStatedErrorCoversNinetyNinePerCentOfRandomPoses) {
  /// Largest number of unknowns. With more, the truth for one of the poses takes as long as for all others.
  constexpr std::size_t most_unknowns = 2000;
  int answered = 0, reached = 0;
  std::array<int, 2> covered{};
  for (unsigned target = 1; target <= 8; ++target) {
    RandomTarget poses(target);
    std::array<ReducedEvaluator, 2> evaluators{ReducedEvaluator(poses.next(), {.rtol = 1e-2}),
                                               ReducedEvaluator(poses.next(), {.rtol = 1e-3})};
    for (int pose = 0; pose < 25; ++pose) {
      const Scene& scene = poses.next();
      MaxwellMatrix truth;
      try {
        truth = maxwell(scene, {.rtol = 1e-3, .most_unknowns = most_unknowns});
      } catch (const InputError&) {
        continue;
      }
      ++answered;
      for (std::size_t k = 0; k < 2; ++k) {
        evaluators[k].set_pose("arm", scene.links[0].pose);
        const MaxwellMatrix& answer = evaluators[k].maxwell();
        covered[k] += covers(answer, truth);
        if (!answer.reached)
          continue;
        ++reached;
        const double allowed = k == 0 ? 1e-2 : 1e-3;
        EXPECT_TRUE(((answer.values - truth.values).array().abs() <=
                     truth.errors.array() + allowed * truth.values.array().abs())
                        .all());
      }
    }
  }
  EXPECT_GT(answered, 150);
  EXPECT_GE(covered[0], 0.99 * answered);
  EXPECT_GE(covered[1], 0.99 * answered);
  EXPECT_GE(reached, 0.8 * 2 * answered) << "an honest answer that is none is of little use";
}

using testing::HasSubstr;

std::string refusal(const std::function<void(Scene&)>& change, const ReducedOptions& options = {}) {
  return test::refusal(change, [&](const Scene& scene) { reduced_capacitance(scene, options); });
}

TEST(ReducedRefusals, TooManyTrianglesByName) {
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].shape = Sphere{0.01, 72};
              }),
              HasSubstr("object \"target\" has 5040 triangles"));
}

TEST(ReducedRefusals, Rooms) {
  EXPECT_THAT(refusal([](Scene& scene) { scene.has_room = true; }), HasSubstr("room"));
}

TEST(ReducedRefusals, ConductorsThatTouchOrCrossByName) {
  const auto named = HasSubstr("sensor \"front\" plates[0] and object \"target\" touch or cross");
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(0.02, 0, 0); }), named);
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(0.1, 0, 0); }), named);
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.objects[0].pose = at(0, 0, 0.02);
                scene.objects[0].pose.rotate(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()));
              }),
              named);
}

TEST(ReducedRefusals, ScenesWithoutAnyConductorThatHasARow) {
  EXPECT_THAT(refusal([](Scene& scene) {
                scene.sensors.clear();
                scene.objects[0].role = Floating{};
              }),
              HasSubstr("neither a sensor nor a grounded object"));
}

TEST(ReducedRefusals, PosesThatAreNotFinite) {
  EXPECT_THAT(refusal([](Scene& scene) { scene.objects[0].pose = at(NAN, 0, 0); }),
              HasSubstr("object \"target\": its pose is not finite"));
}

TEST(ReducedRefusals, OptionsOutOfRange) {
  const auto same = [](Scene&) {};
  EXPECT_THAT(refusal(same, {.rtol = 1e-5}), HasSubstr("rtol 1e-05 must be from 0.0001 to 0.5"));
  EXPECT_THAT(refusal(same, {.rtol = NAN}), HasSubstr("rtol nan must be from"));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
