#include "fringe/scene_reader.hpp"

#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/reading.hpp"
#include "scenes.hpp"
#include "temporary_folder.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

class SceneReader : public test::TemporaryFolder {
 protected:
  Scene read(std::string_view text) const { return load_scene(write("scene.toml", text)); }

  std::string error_of(std::string_view text) const {
    return test::refusal_of([&] { read(text); });
  }
};

constexpr auto complete = R"([medium]
relative_permittivity = 3

[room]
size = [9, 8, 7]
translation = [0, 0, 1]

[[link]]
name = "hand"
parent = "arm"
quaternion = [0, 0, 0, 2]

[[link]]
name = "arm"
translation = [0, 0, 0.5]
rotation = { axis = [0, 0, 1], degrees = 90 }

[[sensor]]
name = "front"
link = "hand"
input_voltage = 5
coupling_capacitance = 1e-12
plates = [
  { corner = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.2, 0] },
  { corner = [1, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.2, 0] },
]

[[distance_sensor]]
name = "eye"
link = "arm"
apex = [1, 2, 3]
direction = [0, 0, 2]
full_angle_degrees = 40
range = 0.8

[[object]]
name = "target"
shape = { type = "plate", size = [0.1, 0.2] }
translation = [0, 0, 0.02]
rotation = { quaternion = [1, 0, 0, 0] }

[[object]]
name = "apple"
link = "arm"
shape = { type = "sphere", radius = 0.05, segments = 12 }
material = { relative_permittivity = 50 }
collides = false

[[object]]
name = "foil"
shape = { type = "plane", size = [1, 1] }
potential = "floating"
conductor = "shield"

[[object]]
name = "shield"
shape = { type = "cube", size = 1 }
potential = "floating"
conductor = "shield"

[[object]]
name = "guard"
shape = { type = "cube", size = 1 }
potential = "electrode"
)";

TEST_F(SceneReader, ReadsEveryKey) {
  const Scene scene = read(complete);
  EXPECT_EQ(scene.medium.relative_permittivity, 3);
  EXPECT_TRUE(scene.has_room);

  ASSERT_EQ(scene.links.size(), 2U);
  EXPECT_EQ(scene.links[0].parent, 1U);
  EXPECT_FALSE(scene.links[1].parent.has_value());
  // Half a turn about z; a quarter turn about z, then up.
  EXPECT_LT((scene.links[0].pose * Vector3d(1, 0, 0) - Vector3d(-1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((scene.links[1].pose * Vector3d(1, 0, 0) - Vector3d(0, 1, 0.5)).norm(), 1e-15);

  ASSERT_EQ(scene.sensors.size(), 1U);
  EXPECT_EQ(scene.sensors[0].link, 0U);
  EXPECT_EQ(scene.sensors[0].input_voltage, 5);
  EXPECT_EQ(scene.sensors[0].coupling_capacitance, 1e-12);
  ASSERT_EQ(scene.sensors[0].plates.size(), 2U);
  EXPECT_EQ(scene.sensors[0].plates[1].corner, Vector3d(1, 0, 0));
  EXPECT_EQ(scene.sensors[0].plates[1].edge_v, Vector3d(0, 0.2, 0));

  ASSERT_EQ(scene.distance_sensors.size(), 1U);
  EXPECT_EQ(scene.distance_sensors[0].apex, Vector3d(1, 2, 3));
  EXPECT_EQ(scene.distance_sensors[0].direction, Vector3d(0, 0, 2));
  EXPECT_EQ(scene.distance_sensors[0].full_angle_degrees, 40);
  EXPECT_EQ(scene.distance_sensors[0].range, 0.8);

  ASSERT_EQ(scene.objects.size(), 5U);
  EXPECT_EQ(std::get<Plate>(scene.objects[0].shape).size_y, 0.2);
  EXPECT_EQ(scene.objects[0].pose.translation(), Vector3d(0, 0, 0.02));
  EXPECT_TRUE(std::holds_alternative<Grounded>(scene.objects[0].role));
  EXPECT_TRUE(scene.objects[0].collides);
  EXPECT_EQ(std::get<Sphere>(scene.objects[1].shape).segments, 12);
  EXPECT_EQ(std::get<Dielectric>(scene.objects[1].role).relative_permittivity, 50);
  EXPECT_FALSE(scene.objects[1].collides);
  EXPECT_TRUE(std::holds_alternative<Floating>(scene.objects[2].role));
  EXPECT_EQ(scene.objects[2].conductor, "shield");
  EXPECT_EQ(scene.objects[3].conductor, "shield");
  EXPECT_TRUE(std::holds_alternative<Electrode>(scene.objects[4].role));
  EXPECT_FALSE(scene.objects[4].conductor.has_value());
}

// Shapes, meshes, plates, poses and joints in any units, and plates that are squared, are compared with what
// the reader of Python makes of them in tests/end_to_end/test_scene_readers_agree.py.
TEST_F(SceneReader, ReadsLimitsOfJointsAndDistanceSensorsInMillimetres) {
  const Scene scene = read(R"(
    units = "mm"
    [[link]]
    name = "arm"
    joint = { name = "slide", type = "prismatic", axis = [0, 0, 1], position = 20, lower = -30, upper = 40 }
    [[link]]
    name = "wheel"
    joint = { name = "turn", type = "revolute", axis = [0, 0, 1], mimic = { joint = "slide", multiplier = 0.5, offset = 0.25 } }
    [[link]]
    name = "rack"
    joint = { name = "push", type = "prismatic", axis = [0, 0, 1], mimic = { joint = "turn", multiplier = 8, offset = 3 } }
    [[sensor]]
    name = "s"
    plates = [ { corner = [-50, 1, 2], edge_u = [100, 0, 0], edge_v = [0, 30, 0] } ]
    [[distance_sensor]]
    name = "eye"
    apex = [1, 2, 3]
    direction = [0, 0, 2]
    full_angle_degrees = 40
    range = 800
  )");
  EXPECT_EQ(scene.links[0].joint->position, 0.02);
  EXPECT_EQ(scene.links[0].joint->lower, -0.03);
  EXPECT_EQ(scene.links[0].joint->upper, 0.04);
  // 0.5 rad per mm, and 8 mm per rad.
  EXPECT_DOUBLE_EQ(scene.links[1].joint->position, 0.5 * 20 + 0.25);
  EXPECT_DOUBLE_EQ(scene.links[2].joint->position, 1e-3 * (8 * (0.5 * 20 + 0.25) + 3));
  EXPECT_EQ(scene.distance_sensors[0].apex, Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(scene.distance_sensors[0].direction, Vector3d(0, 0, 2)) << "which has no length";
  EXPECT_EQ(scene.distance_sensors[0].range, 0.8);
}

TEST(SceneText, TheCoverOfASensorIsALayerOnTheFrontOfEachPlate) {
  const Scene scene = parse_scene(R"(
    [[sensor]]
    name = "front"
    cover = { thickness = 0.002, relative_permittivity = 3 }
    plates = [ { corner = [0, 0, 0], edge_u = [0, 0.1, 0], edge_v = [0.2, 0, 0] },
               { corner = [0, 0, 1], edge_u = [0.1, 0, 0], edge_v = [0, 0.2, 0] } ]
    [[object]]
    name = "hand"
    shape = { type = "cube", size = 0.1 }
  )",
                                  {});
  ASSERT_EQ(scene.objects.size(), 3U);
  EXPECT_EQ(scene.objects[0].name, "front cover");
  EXPECT_EQ(scene.objects[1].name, "front cover 2");
  EXPECT_TRUE(is_cover(scene.objects[0]) && is_cover(scene.objects[1]) && !is_cover(scene.objects[2]));
  EXPECT_EQ(std::get<Cuboid>(scene.objects[0].shape).size_z, 0.002);
  EXPECT_TRUE(scene.objects[0].pose.translation().isApprox(Vector3d(0.1, 0.05, -0.001)));
  EXPECT_TRUE(scene.objects[1].pose.translation().isApprox(Vector3d(0.05, 0.1, 1.001)));
  EXPECT_EQ(targets(scene), (std::vector<bool>{false, false, true}));
}

TEST_F(SceneReader, FillsInDefaults) {
  const Scene scene = read(R"(
    [[sensor]]
    name = "s"
    plates = [ { corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] } ]
    [[object]]
    name = "o"
    shape = { type = "cylinder", radius = 1, height = 1 }
  )");
  EXPECT_EQ(scene.medium.relative_permittivity, 1);
  EXPECT_FALSE(scene.has_room);
  EXPECT_EQ(scene.sensors[0].input_voltage, 2.5);
  EXPECT_EQ(scene.sensors[0].coupling_capacitance, 5e-12);
  EXPECT_FALSE(scene.sensors[0].link.has_value());
  EXPECT_EQ(std::get<Cylinder>(scene.objects[0].shape).segments, 48);
  EXPECT_TRUE(scene.objects[0].pose.isApprox(Eigen::Isometry3d::Identity()));
}

TEST_F(SceneReader, NamesFileLineKeyAndReason) {
  const std::string text =
      "[[object]]\nname = \"target\"\n[object.shape]\ntype = \"plate\"\nsize = [0.1, 0]\n";
  EXPECT_EQ(error_of(text), (folder() / "scene.toml").string() +
                                ":5: object \"target\": shape.size: must be greater than zero");
}

TEST_F(SceneReader, NamesTheTableByItsPlaceWhenItHasNoName) {
  EXPECT_THAT(
      error_of("[[object]]\nname = \"a\"\nshape = { type = \"cube\", size = 1 }\n[[object]]\nshape = 3\n"),
      HasSubstr(":4: object[1].name: is missing"));
}

struct BadScene {
  const char* what;
  std::string text;
  const char* key;
  const char* reason;
};

std::string sensor_with(const std::string& more) {
  return "[[sensor]]\nname = \"s\"\n" + more + "\n";
}

std::string object_with(const std::string& shape) {
  return "[[object]]\nname = \"o\"\nshape = { " + shape + " }\n";
}

// Reasons that list what there is, or hold numbers: every key is spoiled in turn, for this reader and that of
// Python, by tests/bad_input.
TEST_F(SceneReader, RefusesWithKeyAndReason) {
  const std::string square = "{ corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }",
                    skew = "{ corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [2e-4, 1, 0] }";
  for (const BadScene& bad : std::vector<BadScene>{
           {"empty", "", "", "at least one sensor or object"},
           {"plate whose edges are 2e-4 off the right angle", sensor_with("plates = [ " + skew + " ]"),
            "plates[0].edge_v",
            "the angle between them is 89.9885 degrees, its cosine 0.0002, and at most 0.0001 is squared"},
           {"unknown key of a sensor", sensor_with("colour = 1\nplates = [ " + square + " ]"),
            "sensor \"s\": colour",
            "is not a known key; there are coupling_capacitance, cover, input_voltage, link, name, plates"},
           {"unknown shape", object_with("type = \"torus\""), "shape.type",
            "\"torus\" is not a known shape; there are plate (or plane), cuboid (or box), cube"},
           {"rounding of more than half the smallest size",
            object_with("type = \"box\", size = [1, 2, 3], rounding = 0.51"), "shape.rounding",
            "must be from 0 to half the smallest size, 0.5"},
           {"polygon of a vertex with three numbers",
            object_with("type = \"polygon\", vertices = [[0, 0], [1, 0], [1, 1, 1]]"), "shape.vertices[2]",
            "2 numbers"},
       })
    EXPECT_THAT(error_of(bad.text),
                testing::AllOf(HasSubstr("scene.toml:"), HasSubstr(bad.key), HasSubstr(bad.reason)))
        << bad.what;
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
