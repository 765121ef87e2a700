#include "fringe/scene_info.hpp"

#include <gtest/gtest.h>

#include "fringe/pose.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

TEST(SceneInfo, CountsAndMeasuresTheObjectsInTheWorld) {
  Scene scene;
  scene.links.push_back({"table", std::nullopt, pose_from_axis({0, 0, 1}, 90, {0, 0, 1})});
  scene.objects.push_back({"box", 0, Cuboid{2, 4, 6}, Eigen::Isometry3d::Identity(), Grounded{}, true});
  scene.objects.push_back(
      {"sheet", std::nullopt, Plate{1, 3}, Eigen::Isometry3d::Identity(), Floating{}, true});
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

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
