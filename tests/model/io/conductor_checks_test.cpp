#include "fringe/scene_reader.hpp"

#include <string>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "temporary_folder.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using testing::EndsWith;
using testing::StartsWith;

class ConductorChecks : public test::TemporaryFolder {
 protected:
  Scene read(const std::string& text) const { return load_scene(write("scene.toml", text)); }

  /// Returns the message of the error without the file and the line.
  std::string error_of(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_THAT(message, StartsWith((folder() / "scene.toml:").string()));
      return message.substr(message.find(' ') + 1);
    }
    return "no error";
  }
};

std::string sensor(const std::string& name, const std::string& keys = "") {
  return "[[sensor]]\nname = \"" + name +
         "\"\nplates = [ { corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] } ]\n" + keys + "\n";
}

std::string object(const std::string& name, const std::string& keys = "") {
  return "[[object]]\nname = \"" + name + "\"\nshape = { type = \"cube\", size = 1 }\n" + keys + "\n";
}

std::string reading(const std::string& keys) {
  return "[[reading]]\nname = \"r\"\n" + keys + "\n";
}

std::string machine() {
  return sensor("front") + object("guard", R"(potential = "electrode")") +
         object("hand", "potential = \"floating\"\nto_ground = 1e-10\ntarget = true") +
         object("glass", "material = { relative_permittivity = 5 }\ntarget = true");
}

TEST_F(ConductorChecks, ReadsTargetsCapacitancesToGroundAndReadings) {
  const Scene scene = read(machine() + reading(R"(sense = "front"
drive = ["guard", "front"]
noise = 1e-15
threshold = 2e-15)") + "[[reading]]\nname = \"front\"\nsense = \"guard\"\ndrive = [\"front\"]\n");
  ASSERT_EQ(scene.objects.size(), 3U);
  EXPECT_FALSE(scene.objects[0].target);
  EXPECT_TRUE(scene.objects[1].target);
  EXPECT_TRUE(scene.objects[2].target);
  EXPECT_EQ(std::get<Floating>(scene.objects[1].role).to_ground, 1e-10);
  ASSERT_EQ(scene.readings.size(), 2U);
  EXPECT_EQ(scene.readings[0].name, "r");
  EXPECT_EQ(scene.readings[0].sense, "front");
  EXPECT_EQ(scene.readings[0].drive, (std::vector<std::string>{"guard", "front"}));
  EXPECT_EQ(scene.readings[0].noise, 1e-15);
  EXPECT_EQ(scene.readings[0].threshold, 2e-15);
  EXPECT_EQ(scene.readings[1].name, "front");
  EXPECT_FALSE(scene.readings[1].noise.has_value());
  EXPECT_FALSE(scene.readings[1].threshold.has_value());
}

TEST_F(ConductorChecks, ReadsObjectsOfOneConductorThatAreAlike) {
  const std::string keys = "conductor = \"body\"\npotential = \"floating\"\nto_ground = 1e-10\ntarget = true";
  const Scene scene = read(object("head", keys) + object("arm", keys));
  EXPECT_EQ(std::get<Floating>(scene.objects[1].role).to_ground, 1e-10);
  EXPECT_TRUE(scene.objects[1].target);
}

TEST_F(ConductorChecks, LetsAPartOfAGroundedConductorBeATarget) {
  const Scene scene = read(object("table", R"(conductor = "metal")") +
                           object("tool", "conductor = \"metal\"\ntarget = true"));
  EXPECT_TRUE(scene.objects[1].target);
}

TEST_F(ConductorChecks, LetsASensorStandInTheWorldAsTargetsDo) {
  EXPECT_TRUE(read(sensor("front") + object("hand", "target = true")).objects[0].target);
}

TEST_F(ConductorChecks, RejectsCapacitancesToGroundOfWhatDoesNotFloat) {
  EXPECT_EQ(error_of(object("o", "to_ground = 1e-10")),
            R"(object "o": to_ground: is a key of floating objects, and this one is grounded)");
  EXPECT_EQ(error_of(object("o", "potential = \"electrode\"\nto_ground = 1e-10")),
            R"(object "o": to_ground: is a key of floating objects, and this one is electrode)");
  EXPECT_EQ(error_of(object("o", "to_ground = 1e-10\nmaterial = { relative_permittivity = 2 }")),
            R"(object "o": material: cannot be combined with to_ground)");
}

TEST_F(ConductorChecks, RejectsCapacitancesToGroundThatAreNotPositive) {
  for (const char* value : {"0", "-1e-12"})
    EXPECT_EQ(error_of(object("o", std::string("potential = \"floating\"\nto_ground = ") + value)),
              R"(object "o": to_ground: must be greater than zero)");
}

TEST_F(ConductorChecks, RejectsConductorsWithTwoCapacitancesToGround) {
  const std::string keys = "potential = \"floating\"\nconductor = \"c\"\n";
  EXPECT_EQ(error_of(object("o", keys + "to_ground = 1e-10") + object("p", keys)),
            R"(object "p": to_ground: one conductor has one capacitance to ground, but "o" and "p" differ)");
}

TEST_F(ConductorChecks, RejectsElectrodesThatAreTargets) {
  EXPECT_EQ(error_of(object("o", "potential = \"electrode\"\ntarget = true")),
            R"(object "o": target: an electrode cannot be a target)");
}

TEST_F(ConductorChecks, RejectsTargetsThatCarryASensor) {
  EXPECT_EQ(error_of("[[link]]\nname = \"arm\"\n" + sensor("front", R"(link = "arm")") +
                     object("o", "link = \"arm\"\ntarget = true")),
            R"(object "o": target: a target cannot carry a sensor, but its link carries "front")");
}

TEST_F(ConductorChecks, RejectsFloatingConductorsOfWhichAPartIsATarget) {
  const std::string keys = "potential = \"floating\"\nconductor = \"c\"\n";
  const std::string reason =
      R"(object "p": target: all objects of a floating conductor are targets or none is, but )";
  EXPECT_EQ(error_of(object("o", keys + "target = true") + object("p", keys)),
            reason + R"("o" is and "p" is not)");
  EXPECT_EQ(error_of(object("o", keys) + object("p", keys + "target = true")),
            reason + R"("p" is and "o" is not)");
}

struct BadReading {
  const char* keys;
  const char* error;  ///< without the name of the reading
};

void PrintTo(const BadReading& bad, std::ostream* stream) {
  *stream << bad.keys;
}

class BadReadings : public ConductorChecks, public testing::WithParamInterface<BadReading> {};

TEST_P(BadReadings, AreRefusedWithKeyAndReason) {
  EXPECT_EQ(error_of(machine() + reading(GetParam().keys)),
            std::string("reading \"r\": ") + GetParam().error);
}

const std::vector<BadReading> bad_readings{
    {R"(drive = ["front"])", "sense: is missing"},
    {R"(sense = "front")", "drive: is missing"},
    {"sense = \"front\"\ndrive = []", "drive: must not be empty"},
    {"sense = \"front\"\ndrive = \"front\"", "drive: must be a list of strings"},
    {"sense = \"front\"\ndrive = [1]", "drive: must be a list of strings"},
    {"sense = \"front\"\ndrive = [\"front\", \"front\"]", R"(drive: "front" is named twice)"},
    {"sense = \"hand\"\ndrive = [\"front\"]",
     R"(sense: "hand" is neither a sensor nor the conductor of an electrode; the scene has "front", "guard")"},
    {"sense = \"front\"\ndrive = [\"front\", \"nothing\"]",
     R"(drive: "nothing" is neither a sensor nor the conductor of an electrode; the scene has "front", "guard")"},
    {"sense = \"front\"\ndrive = [\"front\"]\nnoise = 0", "noise: must be greater than zero"},
    {"sense = \"front\"\ndrive = [\"front\"]\nnoise = -1e-15", "noise: must be greater than zero"},
    {"sense = \"front\"\ndrive = [\"front\"]\nthreshold = 0", "threshold: must be greater than zero"},
    {"sense = \"front\"\ndrive = [\"front\"]\nthreshold = -1", "threshold: must be greater than zero"},
    {"sense = \"front\"\ndrive = [\"front\"]\ncolour = 1",
     "colour: is not a known key; there are drive, name, noise, sense, threshold"},
};

INSTANTIATE_TEST_SUITE_P(Keys, BadReadings, testing::ValuesIn(bad_readings));

TEST_F(ConductorChecks, RejectsTwoReadingsOfOneName) {
  const std::string one = reading("sense = \"front\"\ndrive = [\"front\"]");
  EXPECT_EQ(error_of(machine() + one + one), R"(reading[1].name: "r" is already used)");
}

TEST_F(ConductorChecks, NamesAnElectrodesConductorInsteadOfItsObjects) {
  const std::string bar = "potential = \"electrode\"\nconductor = \"bars\"";
  const std::string bars = object("left", bar) + object("right", bar);
  EXPECT_EQ(read(bars + reading("sense = \"bars\"\ndrive = [\"bars\"]")).readings[0].sense, "bars");
  EXPECT_EQ(
      error_of(bars + reading("sense = \"left\"\ndrive = [\"bars\"]")),
      R"(reading "r": sense: "left" is neither a sensor nor the conductor of an electrode; the scene has "bars")");
}

TEST_F(ConductorChecks, SaysWhenThereIsNothingToMeasure) {
  EXPECT_EQ(
      error_of(object("o") + reading("sense = \"o\"\ndrive = [\"o\"]")),
      R"(reading "r": sense: "o" is neither a sensor nor the conductor of an electrode; the scene has none)");
}

TEST_F(ConductorChecks, ListsTenNamesAtMost) {
  std::string sensors;
  for (int k = 0; k < 12; ++k)
    sensors += sensor(std::to_string(k));
  EXPECT_THAT(error_of(sensors + reading("sense = \"x\"\ndrive = [\"0\"]")),
              EndsWith(R"(; the scene has "0", "1", "2", "3", "4", "5", "6", "7", "8", "9" and 2 more)"));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
