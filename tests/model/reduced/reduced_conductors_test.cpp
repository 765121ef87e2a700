/// Tests the reduced method with conductors of several bodies, together and apart, and with meshes as
/// computer-aided design leaves them, against boundary elements.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "random_poses.hpp"
#include "reduced/arrangement.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using test::above_sensor;
using test::at;
using test::box;
using test::covers;
using test::object;
using test::sensor;
using test::square;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Options for which few triangles suffice, so that bodies are prepared quickly.
const ReducedOptions loose{.rtol = 0.1};

const Object foot = box("foot", {0, 0, 0}, {6, 2, 2});
const Object leg = box("leg", {0, 2, 0}, {2, 5, 2});

Object angle(std::vector<Triangle> triangles) {
  return object("angle", Mesh{"", 1, std::move(triangles)}, at(0, 0, 0));
}

std::vector<Triangle> angle_piece() {
  return test::angle_iron(0.06, 0.05, 0.02);
}

/// Returns the matrix of the sensor and the angle that foot and leg make, of one clean mesh.
const MaxwellMatrix& clean() {
  static const MaxwellMatrix answer = maxwell(above_sensor({angle(angle_piece())}), {.rtol = 1e-3});
  return answer;
}

void expect_the_clean_answer(const std::vector<Object>& objects, const ReducedOptions& options) {
  const MaxwellMatrix answer = reduced_capacitance(above_sensor(objects), options);
  ASSERT_EQ(answer.values.rows(), 2);
  EXPECT_TRUE(answer.reached) << answer.errors.cwiseQuotient(answer.values);
  EXPECT_TRUE(covers(answer, clean())) << answer.values << "\n" << clean().values << "\n" << answer.errors;
  EXPECT_THAT(answer.lower_bounds, Each(false));
}

/// Returns foot and leg on links of one robot that stands at a distance from the sensor.
Scene on_two_links() {
  Scene scene = above_sensor({foot, leg});
  scene.links = {{"robot", {}, at(0, 0, 0)}, {"upper", 0, at(0, 0, 0)}, {"lower", 0, at(0, 0, 0)}};
  scene.objects[0].link = 1;
  scene.objects[1].link = 2;
  return scene;
}

/// Tests that the rows of the charges are those of the truth, relative to the conductor's own.
void expect_charges(const MaxwellMatrix& answer, const MaxwellMatrix& truth, double tolerance) {
  ASSERT_EQ(answer.members, truth.members);
  EXPECT_LT(((answer.charges - truth.charges).array() / truth.charges.array()).abs().maxCoeff(), tolerance)
      << answer.charges << "\n"
      << truth.charges;
  Eigen::Index row = 0;
  for (Eigen::Index conductor = 0; conductor < answer.values.rows(); ++conductor) {
    const auto members =
        static_cast<Eigen::Index>(answer.members[static_cast<std::size_t>(conductor)].size());
    const Eigen::RowVectorXd sum = answer.charges.middleRows(row, members).colwise().sum();
    EXPECT_LT((sum - answer.values.row(conductor)).norm(), 1e-12 * sum.norm());
    row += members;
  }
}

TEST(ReducedConductorsAtLength, OfTouchingBoxesAnswerAsOneMesh) {
  expect_the_clean_answer({foot, leg}, {.rtol = 1e-2});
}

TEST(ReducedConductorsAtLength, OfOverlappingBoxesAnswerAsOneMesh) {
  expect_the_clean_answer({foot, box("leg", {0, 0, 0}, {2, 5, 2})}, {.rtol = 1e-2});
}

TEST(ReducedConductorsAtLength, DoNotDependOnTheOrientationOfTrianglesNorOnDuplicates) {
  std::vector<Triangle> triangles = angle_piece();
  for (std::size_t k = 0; k < triangles.size(); k += 3)
    std::swap(triangles[k][0], triangles[k][1]);
  for (std::size_t k = 0; k < 20; k += 2)
    triangles.push_back({triangles[k][2], triangles[k][1], triangles[k][0]});
  expect_the_clean_answer({angle(triangles)}, loose);
}

TEST(ReducedConductorsAtLength, DoNotDependOnTJunctions) {
  expect_the_clean_answer({angle(test::with_t_junctions(angle_piece()))}, loose);
}

TEST(ReducedConductorsAtLength, OfMeshesThatCrossAnswerAsOneMesh) {
  expect_the_clean_answer({angle(test::crossing_boxes())}, loose);
}

TEST(ReducedConductors, OfTrianglesThatLieOnEachOtherHaveAnAnswer) {
  std::vector<Triangle> triangles = angle_piece();
  for (std::size_t k = 0; k < 6; ++k)
    triangles.push_back(
        {triangles[k][0], (triangles[k][0] + triangles[k][1]) / 2, (triangles[k][0] + triangles[k][2]) / 2});
  expect_the_clean_answer({angle(triangles)}, loose);
}

TEST(ReducedConductors, MayBeOpenSurfaces) {
  std::vector<Triangle> triangles = angle_piece();
  triangles.pop_back();
  const Scene scene = above_sensor({angle(triangles)});
  EXPECT_TRUE(covers(reduced_capacitance(scene, loose), maxwell(scene, {.rtol = 1e-2})));
}

TEST(ReducedConductorsAtLength, HaveTheChargesOfTheirMembersWhereTheyTouch) {
  const Scene scene = above_sensor({foot, box("apart", {0, 0, 9}, {1, 1, 10}), leg});
  const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-2});
  EXPECT_THAT(answer.conductors, ElementsAre("front", "foot", "apart"));
  EXPECT_THAT(answer.members,
              ElementsAre(ElementsAre("front"), ElementsAre("foot", "leg"), ElementsAre("apart")));
  expect_charges(answer, maxwell(scene, {.rtol = 3e-3}), 2e-2);
}

TEST(ReducedConductors, OfOneNameAreAtOnePotentialWhereverTheyStand) {
  Scene scene = above_sensor({box("front", {0, 0, 0}, {2, 2, 2}), box("between", {3, 0, 0}, {4, 1, 1}),
                              box("back", {0, 0, 5}, {2, 2, 6})});
  scene.objects[0].conductor = scene.objects[2].conductor = "pair";
  const MaxwellMatrix truth = maxwell(scene, {.rtol = 1e-3});
  for (const double rtol : {1e-2, 1e-3}) {
    const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = rtol});
    EXPECT_EQ(answer.conductors, truth.conductors);
    EXPECT_TRUE(answer.reached);
    EXPECT_TRUE(covers(answer, truth));
    expect_charges(answer, truth, rtol == 1e-2 ? 3e-3 : 1e-3);
  }
}

TEST(ReducedConductors, ThatFloatHaveNoChargeTogether) {
  Scene scene = above_sensor({box("front", {0, 0, 0}, {2, 2, 2}), box("hand", {3, 0, 0}, {4, 1, 1}),
                              box("back", {0, 0, 5}, {2, 2, 6})});
  scene.objects[0].conductor = scene.objects[2].conductor = "wire";
  scene.objects[0].role = scene.objects[2].role = Floating{};
  const MaxwellMatrix answer = reduced_capacitance(scene, {.rtol = 1e-3}),
                      truth = maxwell(scene, {.rtol = 1e-3});
  EXPECT_EQ(answer.conductors, truth.conductors);
  EXPECT_TRUE(answer.reached);
  EXPECT_TRUE(covers(answer, truth));
}

TEST(ReducedConductors, OfElectrodesHaveARowAsGroundedOnesHave) {
  Scene scene = above_sensor({foot, leg});
  const MaxwellMatrix grounded = reduced_capacitance(scene, loose);
  for (Object& object : scene.objects) {
    object.role = Electrode{};
    object.conductor = "angle";
  }
  const MaxwellMatrix driven = reduced_capacitance(scene, loose);
  EXPECT_THAT(driven.conductors, ElementsAre("front", "angle"));
  EXPECT_EQ(driven.values, grounded.values);
  EXPECT_EQ(driven.charges, grounded.charges);
}

TEST(ReducedConductors, OfASensorsPlatesAreOnePlate) {
  Scene halves, whole;
  halves.sensors = {
      sensor("front", {{{0, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}, {{0.05, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}}})};
  whole.sensors = {sensor("front", {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}})};
  halves.objects = whole.objects = {box("hand", {0, 0, 3}, {4, 4, 6})};
  const MaxwellMatrix truth = maxwell(whole, {.rtol = 1e-4});
  EXPECT_TRUE(covers(reduced_capacitance(halves, {.rtol = 3e-2}), truth));
  // The plates may also overlap.
  halves.sensors[0].plates[1] = {{0.03, 0, 0}, {0.07, 0, 0}, {0, 0.1, 0}};
  EXPECT_TRUE(covers(reduced_capacitance(halves, {.rtol = 3e-2}), truth));
}

TEST(ReducedConductors, BeforeAMovedSensorAreThoseOfASceneThere) {
  Scene scene = above_sensor({foot, leg});
  scene.links = {{"arm", {}, at(0, 0, 0)}};
  scene.sensors[0].link = 0;
  ReducedEvaluator evaluator(scene, loose);
  for (const double height : {-0.01, -0.05}) {
    scene.links[0].pose = pose_from_axis({1, 1, 0}, 20, {0.01, 0, height});
    evaluator.set_pose("arm", scene.links[0].pose);
    const MaxwellMatrix& answer = evaluator.maxwell();
    EXPECT_EQ(answer.values, reduced_capacitance(scene, loose).values);
    EXPECT_TRUE(covers(answer, maxwell(scene, {.rtol = 1e-2})));
  }
}

TEST(ReducedConductorsAtLength, ThatTouchAcrossLinksAreThoseOfASceneThere) {
  Scene scene = on_two_links();
  ReducedEvaluator evaluator(scene, loose);
  // Touching, shifted along the contact, apart, overlapping, and touching again.
  const std::vector<std::pair<double, double>> places{{0, 0}, {0.01, 0}, {0, 0.02}, {0.01, -0.01}, {0, 0}};
  for (const auto& [x, y] : places) {
    scene.links[2].pose = at(x, y, 0);
    evaluator.set_pose("lower", scene.links[2].pose);
    const MaxwellMatrix &answer = evaluator.maxwell(), there = reduced_capacitance(scene, loose);
    EXPECT_EQ(answer.values.rows(), y > 0 ? 3 : 2);
    EXPECT_EQ(answer.conductors, there.conductors);
    EXPECT_EQ(answer.members, there.members);
    EXPECT_EQ(answer.values, there.values);
    EXPECT_EQ(answer.charges, there.charges);
    EXPECT_TRUE(covers(answer, maxwell(scene, {.rtol = 2e-2}))) << x << " " << y;
  }
}

TEST(ReducedConductors, AreJoinedAnewOnlyWhenTheirBodiesMoveToEachOther) {
  const Scene scene = on_two_links();
  detail::Arrangement arrangement(scene, ReducedContacts::all, 0.1,
                                  std::make_shared<detail::LinkPoses>(scene.links));
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 1U);
  EXPECT_EQ(arrangement.rigid().size(), 2U);
  // The same poses, up to rounding, in another place.
  const Eigen::Isometry3d turn = pose_from_axis({1, 2, 3}, 40, {0.1, 0.2, 0.3});
  arrangement.set_pose("robot", pose_from_axis({3, 2, 1}, 70, {0, 0, 1}));
  arrangement.set_pose("upper", turn);
  arrangement.set_pose("lower", turn);
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 1U);
  arrangement.set_pose("lower", turn * at(0, 1, 0));
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 2U);
  EXPECT_EQ(arrangement.rigid().size(), 3U);
  arrangement.set_pose("upper", at(0, 0, 0));
  arrangement.set_pose("lower", at(0.01, 0, 0));
  arrangement.update();
  EXPECT_EQ(arrangement.joinings(), 3U);
  EXPECT_EQ(arrangement.rigid().size(), 2U);
}

TEST(ReducedConductors, AContactThatIsRefusedIsForgotten) {
  Scene scene = on_two_links();
  ReducedEvaluator evaluator(scene, loose);
  const MatrixXd before = evaluator.maxwell().values;
  evaluator.set_pose("lower", at(0, -0.03, -0.02));
  EXPECT_THAT([&] { evaluator.maxwell(); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("sensor \"front\" plates[0] and object \"leg\" touch or cross"),
                        HasSubstr("they may have different potentials"),
                        HasSubstr("is clear of it when moved by more than"))));
  evaluator.set_pose("lower", at(0, 0, 0));
  EXPECT_EQ(evaluator.maxwell().values, before);
}

TEST(ReducedConductors, AreRefusedInContactAsTheOptionsSay) {
  const auto expect_refusal = [](const Scene& scene, ReducedContacts contacts) {
    EXPECT_THAT([&] { reduced_capacitance(scene, {.rtol = 0.1, .contacts = contacts}); },
                ThrowsMessage<InputError>(HasSubstr("object \"foot\" and object \"leg\" touch")));
  };
  expect_refusal(on_two_links(), ReducedContacts::of_one_link);
  expect_refusal(above_sensor({foot, leg}), ReducedContacts::refused);
  EXPECT_EQ(
      reduced_capacitance(above_sensor({foot, leg}), {.rtol = 0.1, .contacts = ReducedContacts::of_one_link})
          .values.rows(),
      2);
}

TEST(ReducedConductors, OfTooManyTrianglesTogetherAreRefusedByName) {
  EXPECT_THAT(
      [] {
        reduced_capacitance(above_sensor({object("ball", Sphere{0.02, 38}, at(0, 0, 0.05)),
                                          object("other", Sphere{0.02, 38}, at(0.01, 0, 0.05))}));
      },
      ThrowsMessage<InputError>(HasSubstr("object \"ball\" with what touches it has 2736 triangles")));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
