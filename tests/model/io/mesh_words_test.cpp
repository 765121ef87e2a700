/// The words of text mesh files, and the readers of their formats, on any bytes.

#include "io/mesh_words.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "geometry.hpp"
#include "io/mesh_formats.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

TEST(MeshWords, TakeLinesAndWordsUntilNothingIsLeft) {
  std::string_view text = "one two\r\n\n\tthree";
  std::string_view line = take_line(text);
  EXPECT_EQ(take_word(line), "one");
  EXPECT_EQ(take_word(line), "two");
  EXPECT_EQ(take_word(line), "");
  EXPECT_EQ(take_line(text), "");
  line = take_line(text);
  EXPECT_EQ(take_word(line), "three");
  EXPECT_TRUE(text.empty());
  EXPECT_EQ(take_line(text), "");
}

TEST(MeshWords, AreWholeNumbersOrRefused) {
  EXPECT_EQ(parse_number("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(parse_number("+2"), 2);
  EXPECT_EQ(parse_integer("-17"), -17);
  EXPECT_EQ(parse_integer("+9"), 9);
  for (const char* word : {"", "1.5x", "nan", "inf", "1e999", "+-1", "0x10", "1,5", "--1"})
    EXPECT_THROW(parse_number(word), InputError) << word;
  for (const char* word : {"", "1.0", "99999999999999999999", "1e3", "+-1"})
    EXPECT_THROW(parse_integer(word), InputError) << word;
}

TEST(MeshWords, AreQuotedSoThatTheyCanBePrinted) {
  EXPECT_EQ(detail::quoted("f"), "'f'");
  const std::string strange = detail::quoted(std::string("\x1b[31m\0\xff", 7));
  for (const char letter : strange)
    EXPECT_TRUE(letter >= ' ' && letter <= '~') << strange;
  EXPECT_LT(detail::quoted(std::string(1000, 'a')).size(), 60U);
}

/// Spoils some bytes of a text.
std::string spoilt(std::string text, test::Random& random) {
  for (int k = 0; k < 3; ++k)
    text[static_cast<std::size_t>(random.uniform(0, static_cast<double>(text.size())))] =
        "0 1\n-.efvx\0\xff"[static_cast<std::size_t>(random.uniform(0, 12))];
  return text.substr(0, static_cast<std::size_t>(random.uniform(1, 2 * static_cast<double>(text.size()))));
}

TEST(MeshWords, SpoiltFilesAreReadOrRefusedButNothingElse) {
  const std::string
      obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf -1 2/5 3//7\n",
      ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
            "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
            "0\n0 1 0\n3 0 1 2\n",
      stl = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
            "0\nendloop\nendfacet\nendsolid s\n";
  EXPECT_EQ(read_obj(obj).triangles.size(), 2U);
  EXPECT_EQ(read_ply(ply).triangles.size(), 1U);
  EXPECT_EQ(read_stl(stl).triangles.size(), 1U);
  test::Random random(1);
  int read = 0, refused = 0;
  const auto attempt = [&](const auto& reader, const std::string& content) {
    try {
      for (const Triangle& triangle : reader(content).triangles)
        for (const Eigen::Vector3d& corner : triangle)
          EXPECT_TRUE(corner.allFinite());
      ++read;
    } catch (const InputError&) {
      ++refused;
    }
  };
  for (int i = 0; i < test::draws(1000); ++i) {
    attempt(read_obj, spoilt(obj, random));
    attempt(read_ply, spoilt(ply, random));
    attempt(read_stl, spoilt(stl, random));
  }
  EXPECT_GT(read, 0);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
