#include "fringe/remarks.hpp"
#include "fringe/scene_info.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using test::at;
using test::object;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Returns a square sensor of 10 cm and a box of as many 5 cm above it.
Scene sensor_and_box() {
  return test::scene_of(test::square(0.1, 0), {object("hand", Cuboid{0.1, 0.1, 0.1}, at(0, 0, 0.1))});
}

std::vector<std::string> remarks_on(const Scene& scene, const EvaluationOptions& options) {
  return remarks(scene, options, evaluate(scene, options));
}

std::vector<Triangle> reversed(std::vector<Triangle> triangles) {
  for (Triangle& triangle : triangles)
    std::swap(triangle[1], triangle[2]);
  return triangles;
}

TEST(Remarks, AreNoneOnASoundScene) {
  EXPECT_THAT(remarks(sensor_and_box()), IsEmpty());
  for (const char* method : {"exact", "split:2", "reduced", "boundary-elements", "auto"})
    EXPECT_THAT(remarks_on(sensor_and_box(), {.method = parse_method(method)}), IsEmpty()) << method;
}

TEST(Remarks, SayThatARoomIsNotKnown) {
  Scene scene = sensor_and_box();
  scene.has_room = true;
  for (const char* method : {"exact", "auto"})
    EXPECT_THAT(remarks_on(scene, {.method = parse_method(method)}),
                testing::Contains(AllOf(StartsWith("room: the method "), HasSubstr("free space"))))
        << method;
}

TEST(Remarks, AskAboutLengthsThatMayBeInMillimetres) {
  Scene scene = sensor_and_box();
  scene.sensors[0].plates.push_back({{100, 0, 0}, {40, 0, 0}, {0, 30, 0}});
  scene.objects.push_back(object("arm", Mesh{"body.stl", 1, triangulate(Cuboid{1, 179, 1})}, {300, 0, 0}));
  EXPECT_THAT(
      remarks(scene),
      ElementsAre("sensor \"front\": plates[1] is 40 m long: is it in millimetres? Then write units = \"mm\" "
                  "at the top of the scene",
                  "object \"arm\" is 179 m long: is it in millimetres? Then write units = \"mm\" at the top "
                  "of the scene, or scale = 0.001 in the object's shape"));
}

TEST(Remarks, AskAboutASceneThatIsTiny) {
  Scene scene = sensor_and_box();
  scene.sensors[0].plates = {{{0, 0, 0}, {1e-4, 0, 0}, {0, 1e-4, 0}}};
  scene.objects = {object("hand", Sphere{5e-5, 8}, {0, 0, 2e-4})};
  EXPECT_THAT(remarks(scene), ElementsAre(StartsWith("all of the scene is 0.00025 m long")));
  scene.objects.push_back(object("table", Plate{1, 1}, {0, 0, -0.1}));
  EXPECT_THAT(remarks(scene), IsEmpty());
}

TEST(Remarks, NameTrianglesThatDoNotCountAndMeshesThatFaceInwards) {
  Scene scene = sensor_and_box();
  std::vector<Triangle> triangles = triangulate(Cuboid{0.1, 0.1, 0.1});
  const Triangle line{triangles[0][0], triangles[0][0], triangles[0][1]};
  triangles.insert(triangles.end(), {triangles[3], line, triangles[3], line, line});
  scene.objects[0].shape = Mesh{"body.stl", 1, triangles};
  EXPECT_THAT(remarks(scene),
              ElementsAre("object \"hand\": triangles without area: 3, triangles that repeat others: "
                          "2; they are left out"));
  scene.objects[0].shape = Mesh{"body.stl", 1, reversed(triangulate(Cuboid{0.1, 0.1, 0.1}))};
  EXPECT_THAT(remarks(scene), ElementsAre(StartsWith("object \"hand\": its triangles face inwards:")));
}

TEST(Remarks, NameObjectsInsideOthers) {
  Scene scene = sensor_and_box();
  for (const char* name : {"a", "b", "c", "d", "e"})
    scene.objects.push_back(object(name, Sphere{0.01, 8}, {0, 0, 0.1}));
  scene.objects[5].pose = at(0, 0, 0.145);
  EXPECT_THAT(remarks(scene),
              ElementsAre(HasSubstr("object \"hand\" contains \"a\", \"b\", \"c\" and 1 more: ")))
      << "one reaches through the surface";
  // In the hollow of a ring.
  scene.objects = {object("ring", Arc{0.05, 0.06, 0.1, 360, 24}, {0, 0, 0.1}),
                   object("ball", Sphere{0.01, 8}, {0, 0, 0.1})};
  EXPECT_THAT(remarks(scene), IsEmpty());
}

TEST(Remarks, SayThatThereIsNoSensor) {
  Scene scene = sensor_and_box();
  scene.sensors.clear();
  EXPECT_THAT(remarks(scene), IsEmpty());
  EXPECT_THAT(remarks_on(scene, {}), ElementsAre(StartsWith("the scene has no sensor")));
  EXPECT_THAT(remarks_on(scene, {.method = BoundaryElements{}}), IsEmpty())
      << "which finds the object's own capacitance";
  scene.objects[0].role = Electrode{};
  scene.readings = {{.name = "r", .sense = "hand", .drive = {"hand"}}};
  EXPECT_THAT(remarks_on(scene, {}), ElementsAre(HasSubstr("boundary-elements, reduced and auto do")));
}

TEST(Remarks, NameChangesThatAutoTakesFromAMethodWithoutAMatrix) {
  Scene scene = sensor_and_box();
  const EvaluationOptions asked{.method = BoundaryElements{}, .rtol = 0.05};
  Evaluation answer = evaluate(scene, asked);
  EXPECT_THAT(remarks(scene, asked, answer), IsEmpty());
  answer.readings.at(0).answered_by = "reduced";
  const auto remark = StartsWith("reading \"front\": the change is by reduced, which states a smaller error");
  EXPECT_THAT(remarks(scene, asked, answer), ElementsAre(remark));
  scene.objects.push_back(object("cover", Cuboid{0.1, 0.1, 0.001}, at(0, 0, 0.0005), Dielectric{3}));
  scene.objects.back().conductor = "front";
  EXPECT_THAT(remarks(scene, asked, answer),
              ElementsAre(remark, HasSubstr("reduced takes the cover by the layer rule")));
}

TEST(Remarks, NameSheetsOfWhichOnlyBacksAreSeen) {
  Scene scene = sensor_and_box();
  scene.objects = {object("sheet", Mesh{"body.stl", 1, triangulate(Plate{0.1, 0.1})}, {0, 0, 0.05})};
  EXPECT_THAT(remarks_on(scene, {.faces = FaceRule::facing}),
              ElementsAre(StartsWith("sensor \"front\" sees only backs of the triangles of \"sheet\"")));
  EXPECT_THAT(remarks_on(scene, {}), IsEmpty());
  scene.objects[0].shape = Plate{0.1, 0.1};
  EXPECT_THAT(remarks_on(scene, {.faces = FaceRule::facing}), IsEmpty()) << "a plate has two sides";
}

TEST(Remarks, NameObjectsThatShieldOthersWhereTheMethodDoesNotKnowIt) {
  Scene scene = sensor_and_box();
  scene.objects.push_back(object("arm", Cuboid{0.2, 0.1, 0.1}, {0, 0, -0.052}));
  const auto remark =
      StartsWith("sensor \"front\": \"arm\" is close to it or in between, and the method exact knows "
                 "nothing of shielding: what it says of \"hand\" may");
  EXPECT_THAT(remarks_on(scene, {}), ElementsAre(remark));
  EXPECT_THAT(remarks_on(scene, {.method = BoundaryElements{}, .rtol = 0.05}), IsEmpty());
  // Far from the sensor, but in between.
  scene.objects[0].pose = at(0, 0, 1);
  scene.objects[1].pose = at(0, 0, 0.5);
  EXPECT_THAT(remarks_on(scene, {}), ElementsAre(remark));
  // Far from the sensor, and beside.
  scene.objects[1].pose = at(0.5, 0, 0.5);
  EXPECT_THAT(remarks_on(scene, {}), IsEmpty());
}

TEST(SceneInfo, CountsAndMeasuresTheObjectsInTheWorld) {
  Scene scene;
  scene.links.push_back({"table", std::nullopt, pose_from_axis({0, 0, 1}, 90, {0, 0, 1})});
  scene.objects = {test::on_link(0, object("box", Cuboid{2, 4, 6}, at(0, 0, 0))),
                   object("sheet", Plate{1, 3}, at(0, 0, 0), Floating{})};
  const SceneInfo info = scene_info(scene);

  EXPECT_EQ(info.links, 1U);
  EXPECT_EQ(info.sensors, 0U);
  EXPECT_EQ(info.triangles, 14U);
  ASSERT_EQ(info.objects.size(), 2U);

  const ObjectInfo& box = info.objects[0];
  EXPECT_EQ(box.name, "box");
  EXPECT_EQ(box.triangles, 12U);
  EXPECT_NEAR(box.area, 2 * (2 * 4 + 4 * 6 + 6 * 2), 1e-12);
  EXPECT_NEAR(box.volume.value(), 48, 1e-12);
  // The box is rotated by 90° about z, so that its longer horizontal side lies along x, and lifted by 1.
  EXPECT_LT((box.bounding_box.min() - Eigen::Vector3d(-2, -1, -2)).norm(), 1e-14);
  EXPECT_LT((box.bounding_box.max() - Eigen::Vector3d(2, 1, 4)).norm(), 1e-14);

  EXPECT_DOUBLE_EQ(info.objects[1].area, 3);
  EXPECT_FALSE(info.objects[1].volume.has_value()) << "an open surface has no volume";
}

TEST(Remarks, NameObjectsThatAllButTouch) {
  Scene scene = sensor_and_box();
  scene.objects = {object("speck", Plate{1e-20, 1e-20}, {0, 0, 0.03})};
  EXPECT_THAT(remarks_on(scene, {.method = Formula{}}), IsEmpty());
  for (const char* method : {"exact", "formula"})
    for (const double gap : {1e-18, 1e-8}) {
      scene.objects = {object("hand", Plate{0.1, 0.1}, {0, 0, gap})};
      const std::vector<std::string> found = remarks_on(scene, {.method = parse_method(method)});
      if (gap < 1e-9)
        EXPECT_THAT(found, ElementsAre(StartsWith("sensor \"front\": less than 1e-09 m from \"hand\"")))
            << method;
      else
        EXPECT_THAT(found, IsEmpty()) << method;
    }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
