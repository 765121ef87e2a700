/// Tests conductors of several bodies that touch or overlap, and of meshes as computer-aided design leaves
/// them, by boundary elements and by the reduced method: their answers are those of one clean surface.

#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/boundary_elements.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using namespace test;
using testing::ElementsAre;

using Solve = MaxwellMatrix (*)(const Scene&, double rtol);

MaxwellMatrix by_boundary_elements(const Scene& scene, double rtol) {
  return maxwell(scene, {.rtol = rtol});
}

MaxwellMatrix by_the_reduced_method(const Scene& scene, double rtol) {
  return reduced_capacitance(scene, {.rtol = rtol});
}

const Object foot = foot_and_leg()[0], leg = foot_and_leg()[1];
const Object overlapping_leg = box("leg", {0, 0, 0}, {2, 5, 2});

Object angle(std::vector<Triangle> triangles) {
  return object("angle", Mesh{"", 1, std::move(triangles)}, at(0, 0, 0));
}

/// Returns the union of foot and leg.
std::vector<Triangle> angle_piece() {
  return angle_iron(0.06, 0.05, 0.02);
}

std::vector<Triangle> without_orientation() {
  std::vector<Triangle> triangles = angle_piece();
  for (std::size_t k = 0; k < triangles.size(); k += 3)
    std::swap(triangles[k][0], triangles[k][1]);
  return triangles;
}

std::vector<Triangle> with_duplicates(std::vector<Triangle> triangles) {
  for (std::size_t k = 0; k < 20; k += 2)
    triangles.push_back({triangles[k][2], triangles[k][1], triangles[k][0]});
  return triangles;
}

std::vector<Triangle> with_triangles_on_others() {
  std::vector<Triangle> triangles = angle_piece();
  for (std::size_t k = 0; k < 6; ++k)
    triangles.push_back(
        {triangles[k][0], (triangles[k][0] + triangles[k][1]) / 2, (triangles[k][0] + triangles[k][2]) / 2});
  return triangles;
}

/// Loose enough for meshes that cross to be solved in seconds; tests.model.random_soups goes further.
constexpr double rtol_of_elements = 3e-3;
/// The reduced method needs few triangles for this accuracy, so that bodies are prepared quickly.
constexpr double loose = 0.1;

/// Expects the matrix of the sensor and the angle to be that of one clean mesh.
void expect_the_clean_answer(const char* name, Solve solve, double rtol, const std::vector<Object>& objects) {
  SCOPED_TRACE(name);
  static const MaxwellMatrix clean =
      maxwell(above_sensor({angle(angle_piece())}), {.rtol = rtol_of_elements});
  const MaxwellMatrix answer = solve(above_sensor(objects), rtol);
  ASSERT_EQ(answer.values.rows(), 2);
  EXPECT_TRUE(answer.reached) << answer.errors.cwiseQuotient(answer.values) << "\n" << answer.unknowns;
  EXPECT_TRUE(covers(answer, clean)) << answer.values << "\n" << clean.values << "\n" << answer.errors;
  for (const Eigen::Index k : {0, 1})
    EXPECT_TRUE(!answer.lower_bounds[static_cast<std::size_t>(k)] ||
                answer.values(k, k) <= clean.values(k, k) + clean.errors(k, k));
}

TEST(JoinedConductors, AnswerAsOneCleanMesh) {
  expect_the_clean_answer("overlapping boxes", by_boundary_elements, rtol_of_elements,
                          {foot, overlapping_leg});
  expect_the_clean_answer("duplicates", by_boundary_elements, rtol_of_elements,
                          {angle(with_duplicates(angle_piece()))});
  expect_the_clean_answer("triangles on others", by_the_reduced_method, loose,
                          {angle(with_triangles_on_others())});
}

TEST(JoinedConductorsAtLength, AnswerAsOneCleanMesh) {
  for (const auto& [solve, of_boxes, of_triangles] :
       {std::tuple(Solve(by_boundary_elements), rtol_of_elements, rtol_of_elements),
        std::tuple(Solve(by_the_reduced_method), 1e-2, loose)}) {
    expect_the_clean_answer("touching boxes", solve, of_boxes, {foot, leg});
    expect_the_clean_answer("overlapping boxes", solve, of_boxes, {foot, overlapping_leg});
    expect_the_clean_answer("orientation and duplicates", solve, of_triangles,
                            {angle(with_duplicates(without_orientation()))});
    ASSERT_FALSE(is_closed(with_t_junctions(angle_piece())));
    expect_the_clean_answer("T-junctions", solve, of_triangles, {angle(with_t_junctions(angle_piece()))});
    expect_the_clean_answer("meshes that cross", solve, of_triangles, {angle(crossing_boxes())});
  }
}

class ConductorsByMethod : public testing::TestWithParam<std::pair<Solve, double>> {
 protected:
  static MaxwellMatrix solve(const Scene& scene) { return GetParam().first(scene, GetParam().second); }
};

TEST_P(ConductorsByMethod, HaveTheNameOfTheFirstAndTheChargesOfEach) {
  const Scene scene = above_sensor({foot, box("apart", {0, 0, 9}, {1, 1, 10}), leg});
  const MaxwellMatrix answer = solve(scene), truth = maxwell(scene, {.rtol = 3e-3});
  EXPECT_THAT(answer.conductors, ElementsAre("front", "foot", "apart"));
  EXPECT_THAT(answer.members,
              ElementsAre(ElementsAre("front"), ElementsAre("foot", "leg"), ElementsAre("apart")));
  const MatrixXd& charges = answer.charges;
  ASSERT_EQ(charges.rows(), 4);
  // The charges of members are those of their conductor within its errors.
  const auto expect_row = [&](const Eigen::RowVectorXd& sum, Eigen::Index conductor) {
    EXPECT_TRUE(
        ((sum - answer.values.row(conductor)).array().abs() <= answer.errors.row(conductor).array()).all());
  };
  expect_row(charges.row(1) + charges.row(2), 1);
  expect_row(charges.row(3), 2);
  EXPECT_LT(((charges - truth.charges).array() / truth.charges.array()).abs().maxCoeff(), loose);

  const SensorCapacitance felt = capacitance(scene, answer).sensors.at(0);
  ASSERT_EQ(felt.objects.size(), 3U);
  EXPECT_EQ(felt.objects[1].name, "leg");
  EXPECT_EQ(felt.objects[1].capacitance, -charges(2, 0));
  EXPECT_EQ(felt.objects[2].capacitance, answer.mutual(0, 2));
  EXPECT_EQ(answer.conductor_of(1), 1U);
  EXPECT_EQ(answer.conductor_of(2), 2U);
}

TEST_P(ConductorsByMethod, OfOneNameAreAtOnePotentialWhereverTheyStand) {
  Scene scene = above_sensor({box("front", {0, 0, 0}, {2, 2, 2}), box("between", {3, 0, 0}, {4, 1, 1}),
                              box("back", {0, 0, 5}, {2, 2, 6})});
  const MaxwellMatrix apart = maxwell(scene, {.rtol = 1e-3});
  scene.objects[0].conductor = scene.objects[2].conductor = "pair";
  const MaxwellMatrix together = solve(scene);
  EXPECT_THAT(together.conductors, ElementsAre("front", "pair", "between"));
  EXPECT_THAT(together.members,
              ElementsAre(ElementsAre("front"), ElementsAre("front", "back"), ElementsAre("between")));
  MatrixXd sum(4, 3);
  sum << 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0;
  const MatrixXd values = sum.transpose() * apart.values * sum;
  const MatrixXd errors = sum.transpose() * apart.errors * sum + together.errors;
  EXPECT_TRUE(((together.values - values).array().abs() <= errors.array()).all());
  // If both float, their charges add up to zero, and they have no row.
  scene.objects[0].role = scene.objects[2].role = Floating{};
  const MatrixXd floating = solve(scene).values,
                 without = values - values.col(1) * values.row(1) / values(1, 1);
  ASSERT_EQ(floating.rows(), 2);
  for (const Eigen::Index i : {0, 1})
    for (const Eigen::Index j : {0, 1})
      EXPECT_NEAR(floating(i, j), without(2 * i, 2 * j), errors(2 * i, 2 * j));
}

TEST_P(ConductorsByMethod, OfElectrodesHaveARowAsGroundedOnesHaveAndTheNameThatOneObjectGives) {
  Scene scene = above_sensor({foot, leg, target(box("hand", {0, 0, 4}, {4, 4, 6}))});
  scene.objects[1].conductor = "angle";
  const MaxwellMatrix grounded = solve(scene);
  EXPECT_THAT(grounded.conductors, ElementsAre("front", "angle", "hand"));
  for (const std::size_t part : {0, 1}) {
    scene.objects[part].role = Electrode{};
    scene.objects[part].conductor = "angle";
  }
  const MaxwellMatrix driven = solve(scene);
  EXPECT_EQ(driven.conductors, grounded.conductors);
  EXPECT_EQ(driven.sensors, 1U);
  // Each solution has what its iteration leaves, a hundredth of rtol at most.
  EXPECT_TRUE(driven.values.isApprox(grounded.values, 1e-4));
  EXPECT_TRUE(driven.delta_self.isApprox(grounded.delta_self, 1e-4));
}

TEST_P(ConductorsByMethod, OfASensorsPlatesAreOnePlateAlsoWhereTheyOverlap) {
  Scene halves, whole;
  halves.sensors = {
      sensor("front", {{{0, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}, {{0.05, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}})};
  whole.sensors = {sensor("front", {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}})};
  halves.objects = whole.objects = {box("hand", {0, 0, 3}, {4, 4, 6})};
  const MaxwellMatrix truth = maxwell(whole, {.rtol = 1e-4});
  EXPECT_TRUE(covers(solve(halves), truth));
  halves.sensors[0].plates[1] = {{0.03, 0, 0}, {0.07, 0, 0}, {0, 0.1, 0}};
  EXPECT_TRUE(covers(solve(halves), truth));
}

INSTANTIATE_TEST_SUITE_P(By, ConductorsByMethod,
                         testing::Values(std::pair<Solve, double>(by_boundary_elements, 1e-2),
                                         std::pair<Solve, double>(by_the_reduced_method, loose)));

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
