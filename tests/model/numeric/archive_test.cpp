/// What is written to an archive is read back, and what is cut off is refused.

#include "numeric/archive.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

enum class Colour { red, green };

struct Described {
  int number = 0;
  std::vector<std::string> words;

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.number, self.words);
  }
  bool operator==(const Described&) const = default;
};

/// Something of every kind.
struct Everything {
  double number = 0;
  Colour colour = Colour::red;
  std::string text;
  std::optional<int> there, missing = 7;
  std::array<Described, 2> pair;
  std::vector<Eigen::Vector3d> points;
  Eigen::MatrixXf matrix;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::AlignedBox3d box;

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.number, self.colour, self.text, self.there, self.missing, self.pair, self.points,
            self.matrix, self.pose, self.box);
  }
};

Everything filled() {
  test::Random random(1);
  return {.number = -0.1,
          .colour = Colour::green,
          .text = std::string("a\0b", 3),
          .there = 3,
          .missing = {},
          .pair = {Described{1, {"", "one"}}, Described{2, {}}},
          .points = {{1, 2, 3}, {4, 5, 6}},
          .matrix = Eigen::MatrixXf::Random(3, 4),
          .pose = random.rigid_motion(),
          .box = Eigen::AlignedBox3d(Eigen::Vector3d(-1, 0, 1), Eigen::Vector3d(2, 3, 4))};
}

TEST(Archive, GivesBackWhatWasWritten) {
  const Everything before = filled();
  const std::string bytes = bytes_of(before);
  Everything after;
  ArchiveReader reader(bytes);
  reader(after);
  EXPECT_EQ(after.number, before.number);
  EXPECT_EQ(after.colour, before.colour);
  EXPECT_EQ(after.text, before.text);
  EXPECT_EQ(after.there, before.there);
  EXPECT_EQ(after.missing, before.missing);
  EXPECT_EQ(after.pair, before.pair);
  EXPECT_EQ(after.points, before.points);
  EXPECT_EQ(after.matrix, before.matrix);
  EXPECT_EQ(after.pose.matrix(), before.pose.matrix());
  EXPECT_EQ(after.box.min(), before.box.min());
  EXPECT_EQ(after.box.max(), before.box.max());
  EXPECT_EQ(bytes_of(after), bytes);
  EXPECT_THROW(reader(after.number), ArchiveEnds);
}

TEST(Archive, RefusesBytesThatEndAnywhere) {
  const std::string bytes = bytes_of(filled());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ArchiveReader reader(std::string_view(bytes).substr(0, size));
    Everything after;
    EXPECT_THROW(reader(after), ArchiveEnds) << size;
  }
}

// A number of elements far above what the bytes can hold must not be believed: it would take all memory.
TEST(Archive, RefusesCountsThatCannotBe) {
  const std::string bytes = bytes_of(std::size_t{1} << 60U, 0.0);
  std::vector<double> numbers;
  std::vector<std::string> words;
  std::string text;
  EXPECT_THROW(ArchiveReader{bytes}(numbers), ArchiveEnds);
  EXPECT_THROW(ArchiveReader{bytes}(words), ArchiveEnds);
  EXPECT_THROW(ArchiveReader{bytes}(text), ArchiveEnds);
  const std::string sides = bytes_of(Eigen::Index{1} << 40U, Eigen::Index{1} << 40U);
  Eigen::MatrixXd matrix;
  EXPECT_THROW(ArchiveReader{sides}(matrix), ArchiveEnds);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
