/// Tests conductors of several bodies that touch or overlap, and of meshes as computer-aided design leaves
/// them: their answers are those of one clean surface.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bem/bodies.hpp"
#include "bem/hidden_surface.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"

namespace fringe {
namespace {

using Eigen::Vector3d;
using test::at;
using test::object;
using test::sensor;
using test::square;
using testing::ElementsAre;

constexpr double rtol = 1e-3;

/// Returns a box between two corners, in centimetres.
Object box(const std::string& name, const Vector3d& low, const Vector3d& high) {
  const Vector3d size = 0.01 * (high - low), centre = 0.005 * (low + high);
  return object(name, Cuboid{size.x(), size.y(), size.z()}, at(centre.x(), centre.y(), centre.z()));
}

/// Returns a square sensor of 3 cm, 1 cm below the objects.
Scene above_sensor(const std::vector<Object>& objects) {
  Scene scene;
  scene.sensors = {sensor("front", {square(0.03, -0.01)})};
  scene.objects = objects;
  return scene;
}

/// Returns an angle of 6 and 5 cm, 2 cm wide and high, with its outer corner at the origin.
std::vector<Triangle> angle_piece() {
  const std::vector<Vector3d> outline{Vector3d(0, 0, 0),       Vector3d(0.06, 0, 0),
                                      Vector3d(0.06, 0.02, 0), Vector3d(0.02, 0.02, 0),
                                      Vector3d(0.02, 0.05, 0), Vector3d(0, 0.05, 0)};
  const Vector3d up(0, 0, 0.02);
  std::vector<Triangle> triangles;
  for (std::size_t k = 0; k < 6; ++k) {
    const Vector3d &from = outline[k], &to = outline[(k + 1) % 6];
    triangles.push_back({from, to, to + up});
    triangles.push_back({from, to + up, from + up});
    // All of the base is visible from its concave corner.
    if (k == 2 || k == 3)
      continue;
    triangles.push_back({outline[3] + up, from + up, to + up});
    triangles.push_back({outline[3], to, from});
  }
  return triangles;
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

TEST(JoinedConductors, OfTouchingBoxesAnswerAsOneMesh) {
  expect_the_clean_answer({box("foot", {0, 0, 0}, {6, 2, 2}), box("leg", {0, 2, 0}, {2, 5, 2})});
}

TEST(JoinedConductors, OfOverlappingBoxesAnswerAsOneMesh) {
  expect_the_clean_answer({box("foot", {0, 0, 0}, {6, 2, 2}), box("leg", {0, 0, 0}, {2, 5, 2})});
}

TEST(JoinedConductors, DoNotDependOnTheOrientationOfTriangles) {
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

TEST(JoinedConductors, DoNotDependOnTJunctions) {
  std::vector<Triangle> triangles;
  for (const Triangle& triangle : angle_piece()) {
    // Every other triangle is halved, its neighbours are not.
    const Vector3d middle = (triangle[0] + triangle[1]) / 2;
    if (triangles.size() % 3 == 0)
      triangles.push_back({triangle[0], middle, triangle[2]});
    triangles.push_back({triangles.size() % 3 == 1 ? middle : triangle[0], triangle[1], triangle[2]});
  }
  ASSERT_FALSE(is_closed(triangles));
  expect_the_clean_answer({mesh(triangles)});
}

TEST(JoinedConductors, OfMeshesThatCrossAnswerAsOneMesh) {
  std::vector<Triangle> triangles = triangulate(Cuboid{0.06, 0.02, 0.02});
  for (Triangle& triangle : triangles)
    for (Vector3d& corner : triangle)
      corner += Vector3d(0.03, 0.01, 0.01);
  for (Triangle triangle : triangulate(Cuboid{0.02, 0.04, 0.02})) {
    for (Vector3d& corner : triangle)
      corner += Vector3d(0.01, 0.03, 0.01);
    triangles.push_back(triangle);
  }
  expect_the_clean_answer({mesh(triangles)});
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
  const auto expect_equal = [](const Eigen::RowVectorXd& one, const Eigen::RowVectorXd& other) {
    EXPECT_LT((one - other).norm(), 1e-3 * other.norm());
  };
  expect_equal(charges.row(1) + charges.row(2), answer.values.row(1));
  expect_equal(charges.row(3), answer.values.row(2));
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

TEST(JoinedConductors, OfASensorsPlatesAreOnePlate) {
  Scene halves, whole;
  halves.sensors = {
      sensor("front", {{{0, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}, {{0.05, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}})};
  whole.sensors = {sensor("front", {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}})};
  halves.objects = whole.objects = {box("hand", {0, 0, 3}, {4, 4, 6})};
  const MaxwellMatrix one = maxwell(halves, {.rtol = 1e-2}), other = maxwell(whole, {.rtol = 1e-2});
  EXPECT_TRUE(((one.values - other.values).array().abs() <= (one.errors + other.errors).array()).all());
}

TEST(HiddenSurface, IsWhatIsInsideOrLiesOnAnEarlierBody) {
  const detail::ChargedBodies bodies = detail::charged_bodies(
      above_sensor({box("foot", {0, 0, 0}, {6, 2, 2}), box("leg", {0, 2, 0}, {2, 5, 2})}));
  const detail::HiddenSurface hidden(bodies);
  const auto at_height = [](double x, double y) {
    return Triangle{Vector3d(x, y, 0.005), Vector3d(x + 0.004, y, 0.005), Vector3d(x, y, 0.011)};
  };
  EXPECT_TRUE(hidden.contains(at_height(0.01, 0.02), 1)) << "where the two touch";
  EXPECT_TRUE(hidden.contains(at_height(0.01, 0.02), 2));
  EXPECT_TRUE(hidden.contains(at_height(0.01, 0.01), 2)) << "inside the foot";
  EXPECT_FALSE(hidden.contains(at_height(0.03, 0.02), 1)) << "beside the leg";
  EXPECT_FALSE(hidden.contains(at_height(0.018, 0.02), 1)) << "partly beside the leg";
}

}  // namespace
}  // namespace fringe
