#include "geometry/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

TEST(MedianSplit, PutsTheLowerHalfAlongTheLongestSideFirst) {
  test::Random random(1);
  std::vector<Vector3d> points(100);
  std::generate(points.begin(), points.end(), [&] { return random.in_box({0, 0, 0}, {1, 3, 2}); });
  std::vector<std::size_t> numbers(points.size());
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  split_at_median(std::span(numbers), 40, [&](std::size_t i) { return points[i]; });
  const auto lower = [&](std::size_t a, std::size_t b) { return points[a].y() < points[b].y(); };
  EXPECT_LE(points[*std::max_element(numbers.begin(), numbers.begin() + 40, lower)].y(),
            points[*std::min_element(numbers.begin() + 40, numbers.end(), lower)].y());
}

TEST(MedianSplit, OrdersEqualCoordinatesByTheirNumbers) {
  // The initial order is scrambled, so that no library's selection gives the expected one by chance.
  std::vector<std::size_t> numbers(200);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = 77 * i % numbers.size();
  split_at_median(std::span(numbers), 100, [](std::size_t) { return Vector3d(1, 2, 3); });
  EXPECT_EQ(*std::max_element(numbers.begin(), numbers.begin() + 100), 99U);
  EXPECT_EQ(*std::min_element(numbers.begin() + 100, numbers.end()), 100U);
}

TEST(MedianSplit, FindsTheLongestSideOfBoxesWhoseSidesOverflow) {
  const std::vector<Vector3d> points{{0, 1e308, 0}, {1, -1e308, 0}};
  std::vector<std::size_t> numbers{0, 1};
  split_at_median(std::span(numbers), 1, [&](std::size_t i) { return points[i]; });
  EXPECT_EQ(numbers.front(), 1U);
}

class BoxTrees : public testing::TestWithParam<std::size_t> {};

TEST_P(BoxTrees, HoldEveryItemOnceInBoxesAroundIt) {
  test::Random random(2);
  constexpr std::size_t count = 75;
  std::vector<AlignedBox3d> boxes;
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(random.in_box({0, 0, 0}, {1, 1, 1}));
    boxes.emplace_back(points.back() - Vector3d::Constant(0.1), points.back() + Vector3d::Constant(0.1));
  }
  const BoxTree tree(boxes, points, GetParam());
  std::vector<int> found(count, 0);
  const auto look = [&](const auto& self, const BoxTree::Node& node) -> void {
    if (!node.is_leaf()) {
      EXPECT_TRUE(node.box.contains(tree.left(node).box) && node.box.contains(tree.right(node).box));
      self(self, tree.left(node));
      self(self, tree.right(node));
      return;
    }
    EXPECT_LE(node.count, GetParam());
    for (const std::uint32_t item : tree.items().subspan(node.first, node.count)) {
      ++found[item];
      EXPECT_TRUE(node.box.contains(boxes[item]));
      EXPECT_EQ(&tree.leaf_of(item), &node);
    }
  };
  look(look, tree.root());
  EXPECT_EQ(found, std::vector<int>(count, 1));
}

INSTANTIATE_TEST_SUITE_P(LeafSizes, BoxTrees, testing::Values(1, 2, 7));

TEST(BoxTree, GrowsAndShrinksWithWhatMoves) {
  std::vector<AlignedBox3d> boxes;
  for (int i = 0; i < 8; ++i)
    boxes.emplace_back(Vector3d(i, 0, 0), Vector3d(i + 0.5, 1, 1));
  BoxTree tree(boxes);
  const double cost = tree.cost();
  tree.move(3, AlignedBox3d(Vector3d(3, 0, 0), Vector3d(3.5, 1, 9)));
  EXPECT_EQ(tree.root().box.max().z(), 9);
  EXPECT_GT(tree.cost(), cost);
  tree.move(3, boxes[3]);
  EXPECT_EQ(tree.cost(), cost);
  EXPECT_EQ(tree.item(tree.leaf_of(3)), 3U);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
