#include "surface/charged_readings.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

/// A sensor, an electrode, and a grounded and a floating object that cannot be driven.
ChargedBodies four_kinds() {
  Scene scene = test::plate_above_sensor();
  scene.objects.push_back(test::object("pole", Cuboid{0.01, 0.01, 0.01}, test::at(0.2, 0, 0), Electrode{}));
  scene.objects.push_back(test::object("free", Cuboid{0.01, 0.01, 0.01}, test::at(0.3, 0, 0), Floating{}));
  return charged_bodies(scene);
}

TEST(ChargedReadings, SenseAndDriveByTheRowsOfSensorsAndElectrodes) {
  const std::vector<std::string> names = drivable_conductors(four_kinds());
  EXPECT_EQ(names, (std::vector<std::string>{"front", "", "pole", ""}));
  const std::vector<ChargedReading> found =
      charged_readings({{"own", "front", {"front", "pole"}}, {"across", "pole", {"front"}}}, names);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].sense, Eigen::VectorXd::Unit(4, 0));
  EXPECT_EQ(found[0].drive, Eigen::VectorXd(Eigen::VectorXd::Unit(4, 0) + Eigen::VectorXd::Unit(4, 2)));
  // Charge that another conductor induces has the opposite sign.
  EXPECT_EQ(found[1].sense, Eigen::VectorXd(-Eigen::VectorXd::Unit(4, 2)));
}

TEST(ChargedReadings, OfWhatCannotBeDrivenAreRefusedByName) {
  try {
    charged_readings({{"own", "front", {"target"}}}, drivable_conductors(four_kinds()));
    FAIL();
  } catch (const InputError& error) {
    for (const char* part : {"own", "target"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
