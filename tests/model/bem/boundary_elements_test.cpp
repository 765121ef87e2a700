/// Tests Maxwell matrices by boundary elements: published values, symmetries, and properties of every
/// Galerkin method. The set-ups whose matrix is known from another boundary-element method are in
/// test_boundary_elements.py.

#include "bem/jacobi_basis.hpp"
#include "fringe/boundary_elements.hpp"

#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "bem/galerkin_system.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using test::at;
using test::object;
using test::per_length;
using test::sensor;
using test::square;

/// C/4πεa of the unit cube (Helsing and Perfekt 2013).
constexpr double unit_cube = 0.66067815409957;

/// C/4πεa of the square plate, to one unit in the last place (two independent boundary-element computations;
/// HierBEM 0.3667874).
constexpr double unit_square = 0.366788;
constexpr double unit_square_error = 1e-6;

double relative_difference(const MatrixXd& a, const MatrixXd& b) {
  return ((a - b).array() / b.array()).abs().maxCoeff();
}

Scene inclined_box_and_plates() {
  Scene scene;
  scene.sensors = {sensor("left", {{{-0.06, -0.05, 0}, {0.05, 0, 0}, {0, 0.1, 0}}}),
                   sensor("right", {{{0.01, -0.05, 0}, {0.05, 0, 0}, {0, 0.04, 0}},
                                    {{0.01, 0.01, 0}, {0.05, 0, 0}, {0, 0.04, 0}}})};
  Eigen::Isometry3d turned = at(0.02, 0.01, 0.05);
  turned.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0.5).normalized()));
  scene.objects = {object("box", Cuboid{0.04, 0.06, 0.02}, turned),
                   object("plate", Plate{0.08, 0.05}, at(-0.05, 0, -0.02))};
  return scene;
}

TEST(BoundaryElementsAtLength, StateErrorsThatHoldWhereEdgesComeCloseToAFace) {
  // Found among random poses: five and seven functions along each side both miss the other's edges, and
  // agree.
  Eigen::Isometry3d inclined = at(-0.003, 0.003, 0.0092);
  inclined.rotate(Eigen::AngleAxisd(0.0506, Eigen::Vector3d::UnitX()));
  Scene plates, box;
  plates.sensors = box.sensors = {sensor("sensor", {square(0.1, 0)})};
  plates.objects = {object("plate", Plate{0.198, 0.092}, inclined)};
  box.objects = {object("box", Cuboid{0.077, 0.225, 0.05}, at(0, -0.004, 0.0368))};
  for (const Scene& scene : {plates, box}) {
    const MaxwellMatrix truth = maxwell(scene, {.rtol = 1e-4});
    for (const double rtol : {1e-2, 3e-3, 1e-3}) {
      const MaxwellMatrix answer = maxwell(scene, {.rtol = rtol});
      EXPECT_TRUE(
          ((answer.values - truth.values).cwiseAbs().array() <= (answer.errors + truth.errors).array()).all())
          << rtol;
    }
  }
}

TEST(BoundaryElements, WithTooFewUnknownsForTheFeaturesStateLargerErrors) {
  Scene scene;
  scene.sensors = {sensor("sensor", {square(0.1, 0)})};
  scene.objects = {object("plate", Plate{0.2, 0.09}, at(0, 0, 0.004))};
  const MaxwellMatrix truth = maxwell(scene, {.rtol = 1e-4});
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-2, .most_unknowns = 60});
  EXPECT_FALSE(answer.reached);
  EXPECT_TRUE(((answer.values - truth.values).cwiseAbs().array() <= answer.errors.array()).all());
}

TEST(BoundaryElementsAtLength, BeforeAWallFeelWhatIsFeltBeforeTheMirrorImage) {
  // Functions on the whole wall would not resolve the sensor: triangles take their place.
  constexpr double gap = 0.01, corner_of_the_wall = 1e-3;
  Scene wall, box, image;
  wall.sensors = box.sensors = image.sensors = {sensor("sensor", {square(0.1, 0)})};
  wall.objects = {object("wall", Plate{4, 4}, at(0, 0, gap))};
  box.objects = {object("wall", Cuboid{4, 4, 0.2}, at(0, 0, gap + 0.1))};
  image.objects = {object("image", Plate{0.1, 0.1}, at(0, 0, 2 * gap))};
  const MaxwellMatrix mirrored = maxwell(image, {.rtol = 1e-4});
  const double plane = mirrored.values(0, 0) - mirrored.values(0, 1);
  for (const Scene& scene : {wall, box}) {
    const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-2});
    EXPECT_TRUE(answer.reached);
    EXPECT_NEAR(answer.values(0, 0), plane, answer.errors(0, 0) + corner_of_the_wall * plane);
  }
}

TEST(BoundaryElements, ALargeSensorIsFeltByASmallPlateAsAWallIs) {
  Scene scene;
  scene.sensors = {sensor("wall", {square(4, 0)})};
  scene.objects = {object("plate", Plate{0.1, 0.1}, at(0, 0, 0.01))};
  Scene reversed;
  reversed.sensors = {sensor("plate", {square(0.1, 0.01)})};
  reversed.objects = {object("wall", Plate{4, 4}, at(0, 0, 0))};
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-2}), other = maxwell(reversed, {.rtol = 1e-2});
  EXPECT_TRUE(answer.reached);
  EXPECT_NEAR(answer.values(0, 1), other.values(1, 0), answer.errors(0, 1) + other.errors(1, 0));
  EXPECT_EQ(answer.sensors, 1U);
  // Without charge of its own, so small a plate parallel to the wall would have hardly any effect: the effect
  // is that of its charge.
  const double felt = std::pow(answer.values(0, 1), 2) / answer.values(1, 1);
  EXPECT_NEAR(answer.delta_self[0], felt, answer.delta_self_errors[0]);
  EXPECT_LT(answer.delta_self_errors[0], 0.02 * felt);
}

TEST(BoundaryElements, SeeAPlateFourThousandTimesSmaller) {
  // The plate is smaller than any element of the large one before refinement. The truth is known from the
  // mirror image.
  constexpr double side = 1e-3;
  const Shape large = Plate{4, 4};
  for (const double gap : {1e-4, 1e-3})
    for (const Shape& wall : {large, Shape(Mesh{"", 1, triangulate(large)})}) {
      Scene scene, image;
      scene.sensors = image.sensors = {sensor("small", {square(side, 0)})};
      scene.objects = {object("wall", wall, at(0.1, -0.1, -gap))};
      image.objects = {object("image", Plate{side, side}, at(0, 0, -2 * gap))};
      const MaxwellMatrix mirrored = maxwell(image, {.rtol = 1e-4}), answer = maxwell(scene, {.rtol = 1e-2});
      const double plane = mirrored.values(0, 0) - mirrored.values(0, 1);
      EXPECT_TRUE(answer.reached);
      EXPECT_NEAR(answer.values(0, 0), plane, answer.errors(0, 0)) << gap;
    }
}

TEST(BoundaryElements, AgreeWithTheKnownCapacitanceOfASquarePlate) {
  Scene scene;
  scene.sensors = {sensor("plate", {square(0.1, 0)})};
  for (const double rtol : {1e-2, 1e-3, 1e-4}) {
    const MaxwellMatrix answer = maxwell(scene, {.rtol = rtol});
    const double value = per_length(answer.values(0, 0), 0.1), error = per_length(answer.errors(0, 0), 0.1);
    EXPECT_TRUE(answer.reached);
    EXPECT_LE(error, rtol * value);
    EXPECT_LE(value, unit_square + unit_square_error);
    EXPECT_NEAR(value, unit_square, error + unit_square_error);
  }
}

TEST(BoundaryElements, AgreeWithTheKnownCapacitanceOfACube) {
  Scene scene;
  scene.objects = {object("cube", Cuboid{2, 2, 2}, at(0.3, 0, 0))};
  for (const double rtol : {1e-2, 1e-4}) {
    const MaxwellMatrix answer = maxwell(scene, {.rtol = rtol});
    const double value = per_length(answer.values(0, 0), 2), error = per_length(answer.errors(0, 0), 2);
    EXPECT_TRUE(answer.reached && answer.lower_bounds[0]);
    EXPECT_LT(value, unit_cube);
    EXPECT_NEAR(value, unit_cube, error);
  }
}

/// Two-terminal C/(εA/gap), from boundary elements to 1e-4.
TEST(BoundaryElements, AgreeWithKnownCapacitancesOfParallelSquares) {
  constexpr std::array<std::pair<double, double>, 5> known{
      {{0.1, 1.3057}, {0.2, 1.5528}, {0.5, 2.2364}, {1, 3.3430}, {2, 5.581}}};
  for (const auto& [gap, truth] : known) {
    Scene scene;
    scene.sensors = {sensor("lower", {square(1, 0)}), sensor("upper", {square(1, gap)})};
    const MatrixXd m = maxwell(scene, {.rtol = 1e-3}).values;
    const double two_terminal = (m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1)) / (m(0, 0) + m(1, 1) + 2 * m(0, 1));
    EXPECT_NEAR(two_terminal / (vacuum_permittivity / gap), truth, 3e-4 * truth) << gap;
  }
}

TEST(BoundaryElements, ABoxDoesNotDependOnWhichOfItsSidesIsWhich) {
  double first = 0;
  for (const Cuboid& box : {Cuboid{1, 2, 0.3}, Cuboid{0.3, 1, 2}, Cuboid{2, 0.3, 1}}) {
    Scene scene;
    scene.objects = {object("box", box, at(0, 0, 0))};
    const double value = maxwell(scene, {.rtol = 1e-3}).values(0, 0);
    first = first == 0 ? value : first;
    EXPECT_NEAR(value, first, 1e-12 * first);
  }
}

TEST(BoundaryElements, AreInvariantUnderRigidMotion) {
  const Scene scene = inclined_box_and_plates();
  Scene moved = scene;
  Eigen::Isometry3d motion = at(3, -2, 1);
  motion.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -1, 0.4).normalized()));
  moved.links.push_back({"everything", {}, motion});
  for (Sensor& sensor : moved.sensors)
    sensor.link = 0;
  for (Object& object : moved.objects)
    object.link = 0;
  EXPECT_LT(relative_difference(maxwell(moved, {.rtol = 1e-3}).values, maxwell(scene, {.rtol = 1e-3}).values),
            1e-9);
}

TEST(BoundaryElements, GrowWithTheScale) {
  for (const double scale : {1e-6, 1e4}) {
    Scene small, large;
    small.sensors = {sensor("front", {square(1, 0)})};
    small.objects = {object("box", Cuboid{0.5, 0.7, 0.2}, at(0.2, 0, 0.5))};
    large.sensors = {sensor("front", {square(scale, 0)})};
    large.objects = {
        object("box", Cuboid{0.5 * scale, 0.7 * scale, 0.2 * scale}, at(0.2 * scale, 0, 0.5 * scale))};
    EXPECT_LT(relative_difference(maxwell(large, {.rtol = 1e-3}).values,
                                  scale * maxwell(small, {.rtol = 1e-3}).values),
              1e-9);
  }
}

TEST(BoundaryElements, GrowWithThePermittivity) {
  Scene scene = inclined_box_and_plates();
  const MatrixXd vacuum = maxwell(scene, {.rtol = 1e-3}).values;
  scene.medium.relative_permittivity = 3;
  EXPECT_LT(relative_difference(maxwell(scene, {.rtol = 1e-3}).values, 3 * vacuum), 1e-14);
}

TEST(BoundaryElements, AreReciprocalAndPositiveDefinite) {
  const MaxwellMatrix answer = maxwell(inclined_box_and_plates(), {.rtol = 1e-3});
  EXPECT_LT(relative_difference(answer.values, answer.values.transpose()), 1e-13);
  EXPECT_EQ(answer.values.llt().info(), Eigen::Success);
  for (Eigen::Index i = 0; i < answer.values.rows(); ++i)
    EXPECT_GT(answer.values.row(i).sum(), 0) << "all at one potential, every charge is positive";
}

TEST(BoundaryElements, ExchangingTheConductorsExchangesTheEntries) {
  const Scene scene = inclined_box_and_plates();
  Scene exchanged = scene;
  std::swap(exchanged.sensors[0], exchanged.sensors[1]);
  std::swap(exchanged.objects[0], exchanged.objects[1]);
  Eigen::PermutationMatrix<4> order;
  order.indices() << 1, 0, 3, 2;
  const MatrixXd permuted = order * maxwell(exchanged, {.rtol = 1e-3}).values * order;
  EXPECT_LT(relative_difference(permuted, maxwell(scene, {.rtol = 1e-3}).values), 1e-7);
}

/// The space of more functions contains that of fewer: every C_ii grows, by less each time.
TEST(BoundaryElements, ConvergeFromBelow) {
  const detail::ChargedBodies bodies = detail::charged_bodies(inclined_box_and_plates());
  detail::GalerkinSystem system(bodies);
  std::vector<Eigen::VectorXd> diagonals;
  for (const int n : {3, 5, 7, 9}) {
    system.refine(std::vector<detail::FaceFunctions>(system.faces(), {n, n}), 1e-9);
    diagonals.emplace_back(system.solve().all.fine.diagonal());
  }
  for (std::size_t k = 1; k < diagonals.size(); ++k) {
    const Eigen::VectorXd gain = diagonals[k] - diagonals[k - 1];
    EXPECT_GT(gain.minCoeff(), 0);
    if (k > 1) {
      EXPECT_LT((gain.array() / (diagonals[k - 1] - diagonals[k - 2]).array()).maxCoeff(), 0.5);
    }
  }
}

/// The Galerkin error falls like n^(−3.2) or faster on a plate: the field at its corners limits the order.
TEST(BoundaryElements, ConvergeInTheOrderOfTheCorners) {
  Scene scene;
  scene.sensors = {sensor("plate", {square(1, 0)})};
  const detail::ChargedBodies bodies = detail::charged_bodies(scene);
  const auto error = [&](int n) {
    detail::GalerkinSystem system(bodies);
    system.refine({{n, n}}, 1e-9);
    return unit_square - system.solve().all.fine(0, 0);
  };
  EXPECT_GT(std::log(error(3) / error(7)) / std::log(7.0 / 3.0), 3.1);
}

TEST(BoundaryElements, TheStatedErrorCoversTheStricterAnswer) {
  const Scene scene = inclined_box_and_plates();
  const MaxwellMatrix best = maxwell(scene, {.rtol = 1e-4});
  for (const double rtol : {0.1, 1e-2, 1e-3}) {
    const MaxwellMatrix answer = maxwell(scene, {.rtol = rtol});
    EXPECT_TRUE(answer.reached);
    EXPECT_TRUE(((answer.values - best.values).array().abs() <= (answer.errors + best.errors).array()).all());
    EXPECT_TRUE(((answer.delta_self - best.delta_self).array().abs() <=
                 (answer.delta_self_errors + best.delta_self_errors).array())
                    .all());
  }
}

TEST(BoundaryElements, DeltaSelfIsWhatTheObjectsAdd) {
  Scene scene = inclined_box_and_plates();
  const MaxwellMatrix with = maxwell(scene, {.rtol = 1e-3});
  scene.objects.clear();
  const MaxwellMatrix without = maxwell(scene, {.rtol = 1e-3});
  for (Eigen::Index s = 0; s < 2; ++s) {
    EXPECT_GT(with.delta_self[s], 0);
    EXPECT_NEAR(with.delta_self[s], with.values(s, s) - without.values(s, s),
                with.errors(s, s) + without.errors(s, s));
    EXPECT_EQ(without.delta_self[s], 0);
  }
}

TEST(BoundaryElements, AFloatingObjectHasNoChargeAndNoRow) {
  Scene scene = inclined_box_and_plates();
  const MatrixXd grounded = maxwell(scene, {.rtol = 1e-4}).values;
  scene.objects[0].role = Floating{};
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-4});
  EXPECT_EQ(answer.conductors, (std::vector<std::string>{"left", "right", "plate"}));
  EXPECT_EQ(answer.floating, std::vector<std::string>{"box"});
  constexpr std::array<Eigen::Index, 3> kept{0, 1, 3};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double expected =
          grounded(kept[i], kept[j]) - grounded(kept[i], 2) * grounded(2, kept[j]) / grounded(2, 2);
      EXPECT_NEAR(answer.values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)), expected,
                  3e-4 * std::abs(expected));
    }
}

TEST(BoundaryElements, TheSensorFeelsTheMutualCapacitances) {
  const Scene scene = inclined_box_and_plates();
  const MaxwellMatrix matrix = maxwell(scene, {.rtol = 1e-3});
  const SensorCapacitance felt = capacitance(scene, matrix).sensors.at(1);
  EXPECT_EQ(felt.name, "right");
  EXPECT_EQ(felt.objects.at(0).capacitance, -matrix.values(1, 2));
  EXPECT_EQ(felt.total, matrix.mutual(1, 2) + matrix.mutual(1, 3));
  EXPECT_EQ(felt.voltage, divider_voltage(scene.sensors[1], felt.total));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
