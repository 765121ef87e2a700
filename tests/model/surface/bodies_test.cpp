/// Tests what charged bodies are made of: meshes without what carries no charge, and the rows and columns of
/// readings.

#include "surface/charged_readings.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

TEST(CleanedMeshes, LeaveOutTrianglesWithoutAreaSliversAndDuplicates) {
  const Triangle triangle{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0, 0.01, 0)};
  const Triangle turned{triangle[1], triangle[2], triangle[0]}, back{triangle[1], triangle[0], triangle[2]};
  const Triangle flat{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.02, 0, 0)};
  const Triangle needle{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.004, 5e-13, 0)};
  EXPECT_EQ(cleaned("mesh", std::vector<Triangle>{triangle, flat, turned, needle, back}),
            std::vector<Triangle>{triangle});
}

TEST(CleanedMeshes, HaveCornersWeldedThatDifferByRounding) {
  const Triangle one{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const Triangle other{Vector3d(1, 1e-15, 0), Vector3d(1, 1, 0), Vector3d(-1e-15, 1, 0)};
  EXPECT_EQ(cleaned("mesh", std::vector<Triangle>{one, other}),
            (std::vector<Triangle>{one, {one[1], other[1], one[2]}}));
}

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
  EXPECT_THAT(
      [] {
        charged_readings({{"own", "front", {"target"}}}, drivable_conductors(four_kinds()));
      },
      testing::ThrowsMessage<InputError>(testing::AllOf(HasSubstr("own"), HasSubstr("target"))));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
