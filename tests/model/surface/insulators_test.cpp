#include "surface/insulators.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "scenes.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

/// A cube of 10 cm with the given permittivity.
Object cube(const std::string& name, double permittivity, const Vector3d& place) {
  return test::object(name, Cuboid{0.1, 0.1, 0.1}, test::at(place.x(), place.y(), place.z()),
                      Dielectric{permittivity});
}

/// Two cubes that overlap by half, far above a sensor.
InsulatedBodies two_cubes() {
  Scene scene = test::plate_above_sensor();
  scene.objects = {cube("first", 3, {0, 0, 0.5}), cube("second", 5, {0.05, 0, 0.5})};
  return insulated_bodies(scene);
}

/// A small triangle at right angles to the x axis.
Triangle across(double x) {
  return {Vector3d(x, -0.01, 0.5), Vector3d(x, 0.01, 0.5), Vector3d(x, 0, 0.51)};
}

TEST(SurroundingsOfInsulators, TheLaterOneFillsTheCommonSpace) {
  const InsulatedBodies bodies = two_cubes();
  const Surroundings surroundings(bodies, everything(bodies));
  const std::size_t first = bodies.conductors.bodies.size(), second = first + 1;
  const PartState outside = surroundings.state(across(-0.05), first);
  EXPECT_EQ(outside.kind, PartKind::interface);
  EXPECT_TRUE(outside.ratios == (Ratios{1, 3}) || outside.ratios == (Ratios{3, 1}));
  // Within the second cube nothing is left of the first one's face; the second one's borders on the first.
  EXPECT_EQ(surroundings.state(across(0.05), first).kind, PartKind::absent);
  const PartState between = surroundings.state(across(0), second);
  EXPECT_TRUE(between.ratios == (Ratios{3, 5}) || between.ratios == (Ratios{5, 3}));
  EXPECT_TRUE(surroundings.is_outermost(across(-0.05)));
  EXPECT_FALSE(surroundings.is_outermost(across(0)));
}

TEST(SurroundingsOfInsulators, WithoutTheBodiesThereIsNothing) {
  const InsulatedBodies bodies = two_cubes();
  const Surroundings alone(bodies, sensors_alone(bodies));
  EXPECT_EQ(alone.state(across(-0.05), bodies.conductors.bodies.size()).kind, PartKind::absent);
}

TEST(SurroundingsOfInsulators, SurfacesAreDividedWhereTheyMeet) {
  const InsulatedBodies bodies = two_cubes();
  const std::vector<std::vector<Triangle>> parts = divided_surfaces(bodies);
  ASSERT_EQ(parts.size(), bodies.conductors.bodies.size() + 2);
  const Surroundings surroundings(bodies, everything(bodies));
  double area = 0;
  for (std::size_t body = parts.size() - 2; body < parts.size(); ++body)
    for (const Triangle& part : parts[body])
      if (surroundings.is_outermost(part) && surroundings.state(part, body).kind != PartKind::absent)
        area += twice_area(part) / 2;
  EXPECT_NEAR(area, 2 * 0.01 + 4 * 0.015, 1e-9) << "of the box that both are";
}

TEST(SurroundingsOfInsulators, AThinLayerThatIsWiderThanTheConductorBelowIsAFilm) {
  Scene scene = test::plate_above_sensor();
  scene.objects = {test::object("film", Cuboid{0.3, 0.3, 1e-5}, test::at(0, 0, 0.5e-5), Dielectric{80}),
                   test::object("lump", Cuboid{0.01, 0.01, 0.01}, test::at(0, 0, 0.1), Dielectric{80})};
  const InsulatedBodies bodies = with_thin_films(insulated_bodies(scene));
  ASSERT_EQ(bodies.films.size(), 1U);
  EXPECT_NEAR(bodies.films[0].thickness, 1e-5, 1e-12);
  EXPECT_EQ(bodies.insulators.size(), 1U);
}

TEST(SurroundingsOfInsulators, OneWithoutAVolumeIsRefused) {
  Scene scene = test::plate_above_sensor();
  std::vector<Triangle> open = triangulate(Cuboid{0.1, 0.1, 0.1});
  open.pop_back();
  scene.objects = {test::object("open", Mesh{"", 1, open}, test::at(0, 0, 0.5), Dielectric{3})};
  EXPECT_THROW(insulated_bodies(scene), InputError);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
