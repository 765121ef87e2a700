#include "bem/contact.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bem/asked_error.hpp"
#include "bem/believed_error.hpp"
#include "bem/conductors_at_rest.hpp"
#include "bem/face.hpp"
#include "bem/matrix_readings.hpp"
#include "bem/maxwell_matrix.hpp"
#include "bem/readings.hpp"
#include "bem/scenes.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "two_balls.hpp"

/// Conductors by boundary elements: two balls by image charges, and what follows from their matrices. Which
/// bodies are in contact, and what becomes of them.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Triangles lie between the balls of their corners and smaller ones, and charges grow with the bodies.
TEST(ConductorsAtRestTest, TwoBallsHaveTheChargesOfTheirImages) {
  constexpr int segments = 24;
  constexpr double first = 0.05, second = 0.03, distance = 0.1, rtol = 2e-2;
  Scene scene;
  scene.objects = {test::object("first", Sphere{first, segments}, test::at(0, 0, 0), Electrode{}),
                   test::object("second", Sphere{second, segments}, test::at(distance, 0, 0))};
  const ConductorsAtRest found(charged_bodies(scene), rtol, 4000);
  const MatrixXd& matrix = found.matrix();
  ASSERT_EQ(matrix.rows(), 2);
  const double inside = std::pow(std::cos(EIGEN_PI / segments), 2);
  const auto [own, other] = test::two_balls(first, second, distance);
  const auto [least_own, least_other] = test::two_balls(inside * first, inside * second, distance);
  EXPECT_LT(matrix(0, 0), own);
  EXPECT_GT(matrix(0, 0), (1 - rtol) * least_own);
  EXPECT_LT(-matrix(1, 0), -other);
  EXPECT_GT(-matrix(1, 0), -(1 - rtol) * least_other);
  EXPECT_LT(matrix(1, 1), test::two_balls(second, first, distance)[0]);
  EXPECT_NEAR(matrix(0, 1), matrix(1, 0), 1e-3 * std::abs(other));
  // The charges of the panels add up to the matrix.
  MatrixXd sums = MatrixXd::Zero(2, 2);
  for (const PanelGroup& group : found.mesh().groups())
    sums.row(static_cast<Index>(found.bodies().bodies[group.body].conductor)) +=
        found.charges()
            .middleRows(static_cast<Index>(group.first), static_cast<Index>(group.count))
            .colwise()
            .sum();
  EXPECT_LT((sums - matrix).norm(), 1e-2 * matrix.norm());
  EXPECT_LE(found.error(), rtol);
}

/// Two conductors, and two that float of which one has a capacitor to the ground.
ChargedBodies four_conductors() {
  ChargedBodies bodies;
  bodies.conductors = {{"a", Role::sensor, {"a"}},
                       {"b", Role::grounded, {"b"}},
                       {"c", Role::floating, {"c"}},
                       {"d", Role::floating, {"d"}}};
  bodies.conductors[3].to_ground = 0.7;
  for (std::size_t k = 0; k < 4; ++k)
    bodies.bodies.push_back({k, 0, plate_at_origin(1, 1), bodies.conductors[k].name, {}});
  return bodies;
}

/// A Maxwell matrix: symmetric, with dominant diagonal.
const MatrixXd four =
    (MatrixXd(4, 4) << 5, -1, -1.5, -0.5, -1, 6, -2, -1, -1.5, -2, 7, -0.3, -0.5, -1, -0.3, 4).finished();

// Floating conductors take the potentials at which their charge is that of their capacitor, −C·V.
TEST(MaxwellMatrices, ReduceToThoseOfWhatDoesNotFloat) {
  const ChargedBodies bodies = four_conductors();
  const MatrixXd all = potentials(four, bodies), charges = four * all;
  ASSERT_EQ(all.rows(), 4);
  ASSERT_EQ(all.cols(), 2);
  EXPECT_LT((all.topRows(2) - MatrixXd::Identity(2, 2)).norm(), 1e-14);
  EXPECT_LT(charges.row(2).norm(), 1e-14);
  EXPECT_LT((charges.row(3) + 0.7 * all.row(3)).norm(), 1e-14);
  EXPECT_LT((without_floating(four, bodies) - charges.topRows(2)).norm(), 1e-14);
  // Each conductor has one member here.
  EXPECT_LT((member_charges(four, four, bodies) - charges.topRows(2)).norm(), 1e-14);
  EXPECT_LT((floating_block(four, bodies) - (MatrixXd(2, 2) << 7, -0.3, -0.3, 4.7).finished()).norm(), 1e-15);
  EXPECT_EQ(named_answer(bodies).conductors, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(named_answer(bodies).floating, (std::vector<std::string>{"c", "d"}));
}

TEST(MaxwellMatrices, GiveReadingsAsDifferences) {
  Scene scene = test::plate_above_sensor();
  scene.objects.push_back(test::object("housing", Cuboid{0.12, 0.12, 0.03}, test::at(0, 0, -0.04)));
  scene.objects[0].target = true;
  const Scene alone = without_targets(scene);
  ASSERT_EQ(alone.objects.size(), 1U);
  EXPECT_EQ(alone.objects[0].name, "housing");
  const MaxwellMatrix all = maxwell(scene, {.rtol = 1e-3}), background = maxwell(alone, {.rtol = 1e-3});
  const std::vector<ReadingAnswer> found = readings_of_matrices(fringe::readings(scene), all, background);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].value.value.value(), all.values(0, 0), 1e-20);
  EXPECT_NEAR(found[0].change.value.value(), all.values(0, 0) - background.values(0, 0), 1e-20);
  EXPECT_GE(found[0].change.error.value(), all.errors(0, 0));
  const ReadingAnswer& direct = all.readings.at(0);
  EXPECT_LE(std::abs(found[0].change.value.value() - direct.change.value.value()),
            found[0].change.error.value() + direct.change.error.value());
}

TEST(AskedErrors, RefinementIsInVainWhereItHardlyReducesTheExcess) {
  Progress useful, vain;
  double excess = 64;
  for (std::size_t unknowns = 1000; unknowns < 100'000'000; unknowns *= 2) {
    EXPECT_FALSE(useful.is_in_vain(excess, unknowns));
    excess /= 2;
  }
  bool has_ended = false;
  for (std::size_t unknowns = 1000; unknowns < 100'000'000; unknowns *= 2)
    has_ended = has_ended || vain.is_in_vain(64, unknowns);
  EXPECT_TRUE(has_ended);
  Progress beginning;
  EXPECT_FALSE(beginning.is_in_vain(64, 10));
}

/// The answer of one conductor without readings.
MaxwellMatrix answer_of_one(double value, double error) {
  MaxwellMatrix answer;
  answer.values = Eigen::MatrixXd::Constant(1, 1, value);
  answer.errors = Eigen::MatrixXd::Constant(1, 1, error);
  return answer;
}

TEST(BelievedErrors, AreTwiceWhatARefinementUsedOfThem) {
  const auto believed = [](const MaxwellMatrix& first, const MaxwellMatrix& second) {
    ChargedBodies bodies;
    bodies.conductors.push_back({"body", Role::grounded, {"body"}});
    const Eigen::MatrixXd lasting = Eigen::MatrixXd::Zero(1, 1);
    BelievedError error(1);
    EXPECT_EQ(error.next(first, lasting, {}, bodies), 1);
    return error.next(second, lasting, {}, bodies);
  };
  EXPECT_NEAR(believed(answer_of_one(1, 0.4), answer_of_one(1.08, 0.2)), 0.8, 1e-12);
  EXPECT_EQ(believed(answer_of_one(1, 0.4), answer_of_one(1.001, 0.2)), 0.25);
  EXPECT_EQ(believed(answer_of_one(1, 0.4), answer_of_one(1.3, 0.2)), 1);
  EXPECT_EQ(believed(answer_of_one(1, 0.2), answer_of_one(1.001, 0.4)), 1);
  // More than the value cannot have been missing.
  EXPECT_NEAR(believed(answer_of_one(0.9, 4), answer_of_one(1, 0.5)), 0.4, 1e-12);
}

TEST(BelievedErrors, CountAsManyRefinementsAsAreRemembered) {
  ChargedBodies bodies;
  bodies.conductors.push_back({"body", Role::grounded, {"body"}});
  const Eigen::MatrixXd lasting = Eigen::MatrixXd::Zero(1, 1);
  BelievedError error(2);
  std::vector<double> believed;
  for (const auto& [value, stated] :
       std::vector<std::pair<double, double>>{{1, 0.4}, {1.06, 0.2}, {1.061, 0.1}, {1.062, 0.05}})
    believed.push_back(error.next(answer_of_one(value, stated), lasting, {}, bodies));
  EXPECT_EQ(believed[1], 1) << "one refinement is too few";
  EXPECT_NEAR(believed[2], 0.6, 1e-9) << "the first used more";
  EXPECT_EQ(believed[3], 0.25);
}

TEST(AskedErrors, AreRelativeToTheLargerOfChangeAndAPartOfTheValue) {
  EXPECT_EQ(change_scale(1, 0.5), 0.5);
  EXPECT_EQ(change_scale(1, -0.5), 0.5);
  EXPECT_GT(change_scale(1, 0), 0);
  EXPECT_LT(change_scale(1, 0), 0.1);
}

/// Two bodies, the second one turned and moved.
ChargedBodies two_bodies(const Shape& first, const Shape& second, const Eigen::Isometry3d& pose,
                         const ElectricalRole& role = Grounded{}) {
  Scene scene;
  scene.objects = {test::object("first", first, test::at(0, 0, 0)),
                   test::object("second", second, pose, role)};
  return bodies_on_links(scene);
}

bool touch(const Shape& first, const Shape& second, const Eigen::Isometry3d& pose) {
  const ChargedBodies bodies = two_bodies(first, second, pose);
  const bool found = are_in_contact(bodies.bodies[0], bodies.bodies[1]);
  EXPECT_EQ(are_in_contact(bodies.bodies[1], bodies.bodies[0]), found);
  return found;
}

TEST(Contact, IsWhereBodiesTouchOverlapOrContainEachOther) {
  const Cuboid cube{0.1, 0.1, 0.1}, small{0.01, 0.01, 0.01};
  const Plate plate{0.05, 0.05};
  for (const Shape& second : std::vector<Shape>{cube, small, plate, Sphere{0.05, 8}}) {
    EXPECT_TRUE(touch(cube, second, test::at(0.04, 0, 0)));
    EXPECT_TRUE(touch(cube, second, test::at(0, 0, 0)));
    EXPECT_FALSE(touch(cube, second, test::at(0.2, 0, 0)));
  }
  EXPECT_TRUE(touch(cube, cube, test::at(0.1, 0.02, 0.03)));
  EXPECT_TRUE(touch(cube, cube, test::at(0.1 * (1 + 1e-15), 0, 0)));
  EXPECT_FALSE(touch(cube, cube, test::at(0.1001, 0, 0)));
  // Two plates that cross, and two of one plane beside each other.
  EXPECT_TRUE(touch(plate, plate, pose_from_axis({1, 0, 0}, 90, {0, 0, 0})));
  EXPECT_FALSE(touch(plate, plate, test::at(0.0501, 0, 0)));
  EXPECT_FALSE(touch(plate, plate, test::at(0, 0, 0.001)));
}

TEST(Contact, OfRoundBodiesAtDifferentPotentialsIsThatOfTheShapes) {
  // In this direction the polyhedra of 12 segments reach 3 % less far than the shapes.
  const Vector3d direction(std::cos(std::numbers::pi / 12), std::sin(std::numbers::pi / 12), 0);
  const Sphere ball{0.05, 12};
  const auto is_refused = [](const Shape& first, const Shape& second, const Eigen::Isometry3d& pose) {
    const ChargedBodies bodies = two_bodies(first, second, pose, Electrode{});
    const auto throws = [&](std::size_t a, std::size_t b) {
      try {
        refuse_contact(bodies.bodies[a], bodies.bodies[b], "they may differ");
        return false;
      } catch (const InputError&) {
        return true;
      }
    };
    EXPECT_EQ(throws(1, 0), throws(0, 1));
    return throws(0, 1);
  };
  const auto away = [&](double distance) {
    const Vector3d place = distance * direction;
    return test::at(place.x(), place.y(), place.z());
  };
  EXPECT_FALSE(are_in_contact(two_bodies(ball, ball, away(0.0995)).bodies[0],
                              two_bodies(ball, ball, away(0.0995)).bodies[1]));
  EXPECT_TRUE(is_refused(ball, ball, away(0.0995)));
  EXPECT_FALSE(is_refused(ball, ball, away(0.1005)));
  const Eigen::Isometry3d turned = pose_from_axis({0, 0, 1}, 15, {0, 0, 0});
  const Cuboid cube{0.02, 0.02, 0.02};
  EXPECT_TRUE(is_refused(ball, cube, away(0.0595) * turned));
  EXPECT_FALSE(is_refused(ball, cube, away(0.0601) * turned));
  const Cylinder rod{0.05, 0.1, 12};
  EXPECT_TRUE(is_refused(rod, rod, away(0.0995)));
  EXPECT_FALSE(is_refused(rod, rod, away(0.1005)));
}

TEST(Contact, AtOnePotentialJoinsBodiesToOneConductor) {
  const Cuboid cube{0.1, 0.1, 0.1};
  const ChargedBodies apart = two_bodies(cube, cube, test::at(0.2, 0, 0)),
                      touching = two_bodies(cube, cube, test::at(0.1, 0, 0));
  EXPECT_TRUE(contacts_at_one_potential(apart).empty());
  EXPECT_EQ(joined(apart).conductors.size(), 2U);
  ASSERT_EQ(contacts_at_one_potential(touching), (std::vector<Contact>{{0, 1}}));
  EXPECT_TRUE(have_one_potential(touching, 0, 1));
  const ChargedBodies one = joined(touching);
  ASSERT_EQ(one.conductors.size(), 1U);
  EXPECT_EQ(one.conductors[0].name, "first");
  EXPECT_EQ(one.conductors[0].members, (std::vector<std::string>{"first", "second"}));
  for (const ChargedBody& body : one.bodies)
    EXPECT_FALSE(triangles_of(body.surface).empty());
  const ChargedBodies other = two_bodies(cube, cube, test::at(0.1, 0, 0), Floating{});
  EXPECT_FALSE(have_one_potential(other, 0, 1));
  EXPECT_THROW(joined(other), InputError);
  try {
    refuse_contact(other.bodies[0], other.bodies[1], "because");
    FAIL();
  } catch (const InputError& error) {
    for (const char* part : {"first", "second", "because"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
  EXPECT_NO_THROW(refuse_contact(apart.bodies[0], apart.bodies[1], "because"));
}

TEST(Contact, TrianglesOfABoxFaceOutwardsAndCoverItsFaces) {
  const Vector3d half(0.3, 0.2, 0.1);
  const BoxSurface box = box_at_origin(half);
  double of_faces = 0, of_triangles = 0, volume = 0;
  for (const ChargedFace& face : box.faces) {
    of_faces += 4 * face.half_u * face.half_v;
    for (const Vector3d& corner : corners_of(face))
      EXPECT_LT((corner.cwiseAbs() - half).norm(), 1e-15);
  }
  for (const Triangle& triangle : oriented_triangles(box).triangles) {
    const Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    EXPECT_GT(normal.dot(triangle[0]), 0);
    of_triangles += normal.norm() / 2;
    volume += normal.dot(triangle[0]) / 6;
  }
  EXPECT_NEAR(of_triangles, of_faces, 1e-14);
  EXPECT_NEAR(volume, 8 * half.prod(), 1e-15);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
