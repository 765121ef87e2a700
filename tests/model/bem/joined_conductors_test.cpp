/// Tests conductors of several bodies that touch or overlap, and of meshes as computer-aided design leaves
/// them: their answers are those of one clean surface.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bem/panel_system.hpp"
#include "fringe/boundary_elements.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::above_sensor;
using test::at;
using test::box;
using test::object;
using test::sensor;
using testing::ElementsAre;

/// Loose enough for meshes that cross to be solved in seconds; tests.model.random_soups goes further.
constexpr double rtol = 3e-3;

/// Returns the union of the two boxes that the tests call foot and leg.
std::vector<Triangle> angle_piece() {
  return test::angle_iron(0.06, 0.05, 0.02);
}

Object mesh(std::vector<Triangle> triangles) {
  return object("angle", Mesh{"", 1, std::move(triangles)}, at(0, 0, 0));
}

/// Returns the matrix of the sensor and the angle made of one clean mesh.
const MaxwellMatrix& clean() {
  static const MaxwellMatrix answer = maxwell(above_sensor({mesh(angle_piece())}), {.rtol = rtol});
  return answer;
}

void expect_the_clean_answer(const std::vector<Object>& objects) {
  const MaxwellMatrix answer = maxwell(above_sensor(objects), {.rtol = rtol});
  ASSERT_EQ(answer.values.rows(), 2);
  EXPECT_TRUE(answer.reached) << answer.errors.cwiseQuotient(answer.values) << "\n" << answer.unknowns;
  const Eigen::MatrixXd difference = (answer.values - clean().values).cwiseAbs();
  EXPECT_TRUE((difference.array() <= (answer.errors + clean().errors).array()).all())
      << answer.values << "\n"
      << clean().values << "\n"
      << answer.errors + clean().errors;
  EXPECT_LE(std::abs(answer.delta_self[0] - clean().delta_self[0]),
            answer.delta_self_errors[0] + clean().delta_self_errors[0]);
  for (const Eigen::Index k : {0, 1})
    EXPECT_TRUE(!answer.lower_bounds[static_cast<std::size_t>(k)] ||
                answer.values(k, k) <= clean().values(k, k) + clean().errors(k, k));
}

TEST(JoinedConductorsAtLength, OfTouchingBoxesAnswerAsOneMesh) {
  expect_the_clean_answer({box("foot", {0, 0, 0}, {6, 2, 2}), box("leg", {0, 2, 0}, {2, 5, 2})});
}

TEST(JoinedConductors, OfOverlappingBoxesAnswerAsOneMesh) {
  expect_the_clean_answer({box("foot", {0, 0, 0}, {6, 2, 2}), box("leg", {0, 0, 0}, {2, 5, 2})});
}

TEST(JoinedConductorsAtLength, DoNotDependOnTheOrientationOfTriangles) {
  std::vector<Triangle> triangles = angle_piece();
  for (std::size_t k = 0; k < triangles.size(); k += 3)
    std::swap(triangles[k][0], triangles[k][1]);
  expect_the_clean_answer({mesh(triangles)});
}

TEST(JoinedConductors, DoNotDependOnDuplicates) {
  std::vector<Triangle> triangles = angle_piece();
  for (std::size_t k = 0; k < 20; k += 2)
    triangles.push_back({triangles[k][2], triangles[k][1], triangles[k][0]});
  expect_the_clean_answer({mesh(triangles)});
}

TEST(JoinedConductorsAtLength, DoNotDependOnTJunctions) {
  const std::vector<Triangle> triangles = test::with_t_junctions(angle_piece());
  ASSERT_FALSE(is_closed(triangles));
  expect_the_clean_answer({mesh(triangles)});
}

TEST(JoinedConductorsAtLength, OfMeshesThatCrossAnswerAsOneMesh) {
  expect_the_clean_answer({mesh(test::crossing_boxes())});
}

TEST(JoinedConductors, OfMeshesWhoseNeighboursOverlapAreSolved) {
  // Squares, each divided by either diagonal: four triangles, one of which depends on the others. So many
  // triangles are grouped with their neighbours.
  std::vector<Triangle> triangles;
  for (int x = 0; x < 11; ++x)
    for (int y = 0; y < 11; ++y) {
      const Vector3d a = 0.005 * Vector3d(x, y, 0), b = a + Vector3d(0.005, 0, 0),
                     c = b + Vector3d(0, 0.005, 0), d = a + Vector3d(0, 0.005, 0);
      for (const Triangle& triangle :
           {Triangle{a, b, c}, Triangle{a, c, d}, Triangle{a, b, d}, Triangle{b, c, d}})
        triangles.push_back(triangle);
    }
  const detail::ChargedBodies bodies = detail::charged_bodies(above_sensor({mesh(triangles)}));
  detail::PanelSystem system(bodies, {.missing = 0.01, .most_panels = 5000});
  system.refine({{5, 5}}, 4e-7);
  EXPECT_TRUE(system.solve(1e-4).positive_definite);
}

TEST(JoinedConductors, ThatShieldOthersEndRefinement) {
  // An open mesh does not contain the box, which is grounded by itself; its entry beside the sensor's
  // vanishes, so that no error of it is small relative to it.
  std::vector<Triangle> housing = angle_piece();
  std::swap(housing[0][0], housing[0][1]);
  const MaxwellMatrix answer =
      maxwell(above_sensor({mesh(housing), box("inside", {1, 0.5, 0.5}, {2, 1.5, 1.5})}), {.rtol = 3e-1});
  ASSERT_EQ(answer.values.rows(), 3);
  EXPECT_TRUE(answer.reached);
  EXPECT_LE(std::abs(answer.values(0, 2)), answer.errors(0, 2));
  EXPECT_LE(answer.errors(0, 2), 3e-1 * 1e-3 * std::sqrt(answer.values(0, 0) * answer.values(2, 2)));
  for (const Eigen::Index k : {0, 1})
    EXPECT_LE(std::abs(answer.values(0, k) - clean().values(0, k)),
              answer.errors(0, k) + clean().errors(0, k));
}

TEST(JoinedConductors, HaveTheNameOfTheFirstAndTheChargesOfEach) {
  const Scene scene = above_sensor({box("foot", {0, 0, 0}, {6, 2, 2}), box("apart", {0, 0, 9}, {1, 1, 10}),
                                    box("leg", {0, 2, 0}, {2, 5, 2})});
  const MaxwellMatrix answer = maxwell(scene, {.rtol = 1e-2});
  EXPECT_THAT(answer.conductors, ElementsAre("front", "foot", "apart"));
  EXPECT_THAT(answer.members,
              ElementsAre(ElementsAre("front"), ElementsAre("foot", "leg"), ElementsAre("apart")));
  const Eigen::MatrixXd& charges = answer.charges;
  ASSERT_EQ(charges.rows(), 4);
  // The charges of members are those of their conductor within its errors.
  const auto expect_row = [&](const Eigen::RowVectorXd& sum, Eigen::Index conductor) {
    EXPECT_TRUE(
        ((sum - answer.values.row(conductor)).array().abs() <= answer.errors.row(conductor).array()).all());
  };
  expect_row(charges.row(1) + charges.row(2), 1);
  expect_row(charges.row(3), 2);
  EXPECT_LT(charges(1, 0), charges(2, 0))
      << "the foot is nearer to the sensor: it takes more negative charge";

  const SensorCapacitance felt = capacitance(scene, answer).sensors.at(0);
  ASSERT_EQ(felt.objects.size(), 3U);
  EXPECT_EQ(felt.objects[1].name, "leg");
  EXPECT_EQ(felt.objects[1].capacitance, -charges(2, 0));
  EXPECT_EQ(felt.objects[2].capacitance, answer.mutual(0, 2));
  EXPECT_EQ(answer.conductor_of(1), 1U);
  EXPECT_EQ(answer.conductor_of(2), 2U);
}

TEST(JoinedConductors, OfOneNameAreAtOnePotentialWhereverTheyStand) {
  Scene scene = above_sensor({box("front", {0, 0, 0}, {2, 2, 2}), box("between", {3, 0, 0}, {4, 1, 1}),
                              box("back", {0, 0, 5}, {2, 2, 6})});
  const MaxwellMatrix apart = maxwell(scene, {.rtol = 1e-2});
  scene.objects[0].conductor = scene.objects[2].conductor = "pair";
  const MaxwellMatrix together = maxwell(scene, {.rtol = 1e-2});
  EXPECT_THAT(together.conductors, ElementsAre("front", "pair", "between"));
  EXPECT_THAT(together.members,
              ElementsAre(ElementsAre("front"), ElementsAre("front", "back"), ElementsAre("between")));
  Eigen::MatrixXd sum(4, 3);
  sum << 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0;
  const Eigen::MatrixXd values = sum.transpose() * apart.values * sum;
  const Eigen::MatrixXd errors = sum.transpose() * apart.errors * sum + together.errors;
  EXPECT_TRUE(((together.values - values).array().abs() <= errors.array()).all());
}

TEST(JoinedConductors, HaveTheNameThatOneOfTheirObjectsGivesThem) {
  Scene scene = above_sensor({box("foot", {0, 0, 0}, {6, 2, 2}), box("leg", {0, 2, 0}, {2, 5, 2})});
  scene.objects[1].conductor = "angle";
  EXPECT_THAT(maxwell(scene, {.rtol = 1e-1}).conductors, ElementsAre("front", "angle"));
}

TEST(JoinedConductors, OfElectrodesHaveARowAsGroundedOnesHave) {
  Scene scene = above_sensor({mesh(angle_piece()), box("hand", {0, 0, 4}, {4, 4, 6})});
  scene.objects[1].target = true;
  const MaxwellMatrix grounded = maxwell(scene, {.rtol = 1e-2});
  scene.objects[0].role = Electrode{};
  const MaxwellMatrix driven = maxwell(scene, {.rtol = 1e-2});
  EXPECT_THAT(driven.conductors, ElementsAre("front", "angle", "hand"));
  EXPECT_EQ(driven.sensors, 1U);
  // Each solution has what its iteration leaves, a hundredth of rtol at most.
  EXPECT_TRUE(driven.values.isApprox(grounded.values, 1e-4));
  EXPECT_TRUE(driven.delta_self.isApprox(grounded.delta_self, 1e-4));
}

TEST(JoinedConductors, OfASensorsPlatesAreOnePlate) {
  Scene halves, whole;
  halves.sensors = {
      sensor("front", {{{0, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}, {{0.05, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}})};
  whole.sensors = {sensor("front", {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}})};
  halves.objects = whole.objects = {box("hand", {0, 0, 3}, {4, 4, 6})};
  const MaxwellMatrix one = maxwell(halves, {.rtol = 1e-2}), other = maxwell(whole, {.rtol = 1e-2});
  EXPECT_TRUE(((one.values - other.values).array().abs() <= (one.errors + other.errors).array()).all());
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
