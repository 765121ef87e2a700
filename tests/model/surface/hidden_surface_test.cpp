#include "surface/hidden_surface.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "surface/bodies.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using namespace test;

TEST(HiddenSurface, IsWhatIsInsideOrLiesOnAnEarlierBody) {
  const detail::ChargedBodies bodies = detail::charged_bodies(above_sensor(foot_and_leg()));
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

TEST(HiddenSurface, KeepsOneOfTwoFacesThatLieOnEachOtherWhateverElseTheirBodiesHold) {
  // The first body also has a sheet, which is not closed; the second one contains it up to their common
  // faces.
  std::vector<Triangle> with_sheet = triangulate(Cuboid{0.02, 0.02, 0.02}),
                        whole = triangulate(Cuboid{0.04, 0.02, 0.02});
  with_sheet.push_back({Vector3d(0, 0, 0), Vector3d(0.005, 0, 0), Vector3d(0, 0.005, 0)});
  const Object first = object("first", Mesh{"", 1, with_sheet}, at(0.01, 0, 0.02)),
               second = object("second", Mesh{"", 1, whole}, at(0.02, 0, 0.02));
  for (const std::vector<Object>& order : {std::vector{first, second}, std::vector{second, first}}) {
    const detail::ChargedBodies bodies = detail::charged_bodies(above_sensor(order));
    const detail::HiddenSurface hidden(bodies);
    double visible = 0;
    for (std::size_t body = 1; body < bodies.bodies.size(); ++body)
      for (const Triangle& triangle : triangles_of(bodies.bodies[body].surface))
        if (!hidden.contains(triangle, body))
          visible += area({&triangle, 1});
    EXPECT_GE(visible, area(whole) * (1 - 1e-12));
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
