#include "fringe/mesh_file.hpp"
#include "io/input_file.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "io/mesh_formats.hpp"
#include "temporary_folder.hpp"

/// The words of text mesh files, and the readers of their formats; on any bytes tests/fuzz tries them.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;

class MeshFile : public test::TemporaryFolder {
 protected:
  void expect_refused(const std::string& name, const std::string& content, const std::string& reason) const {
    EXPECT_THAT([&] { read_mesh_file(write(name, content)); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr(reason)))
        << name;
  }
};

const std::string ascii_stl = R"(solid two
facet normal 0 0 1
outer loop
vertex 0 0 1
vertex 1 0 1
vertex 0 1 1
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid two
)";

const std::string obj = R"(v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0.5 2 0
l 1 2
f 1 2 3 5 4
f 3 2 1
)";

const std::string ascii_ply = R"(ply
format ascii 1.0
comment four corners
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
1 1 0
0 1 0
4 0 1 2 3
3 2 1 0
)";

// Files of bytes are held against the reader of Python by tests/bad_input.
TEST_F(MeshFile, OfEveryFormatKeepsTheOrderOfTheFile) {
  EXPECT_THAT(read_mesh_file(write("two.stl", ascii_stl)),
              ElementsAre(Triangle{Vector3d{0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                          Triangle{Vector3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  // Convex polygons become fans from their first vertex; lines are skipped.
  const Vector3d a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0), e(0.5, 2, 0);
  EXPECT_THAT(read_mesh_file(write("four.ply", ascii_ply)),
              ElementsAre(Triangle{a, b, c}, Triangle{a, c, d}, Triangle{c, b, a}));
  EXPECT_THAT(read_mesh_file(write("five.obj", obj)),
              ElementsAre(Triangle{a, b, c}, Triangle{a, c, e}, Triangle{a, e, d}, Triangle{c, b, a}));
}

TEST_F(MeshFile, ObjMayBeInUtf16AndHaveAMarkAndCarriageReturnsOnly) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::string little = "\xFF\xFE", big = "\xFE\xFF", old = text;
  for (const char letter : text) {
    little += std::string{letter, '\0'};
    big += std::string{'\0', letter};
  }
  std::replace(old.begin(), old.end(), '\n', '\r');
  for (const std::string& content : {little, big, old, "\xEF\xBB\xBF" + text})
    EXPECT_EQ(read_mesh_file(write("text.obj", content)).size(), 1U);
  expect_refused("text.obj", little + "v", "is damaged text in UTF-16");
  expect_refused("text.obj", little + std::string("\0\xD8", 2), "is damaged text in UTF-16");
}

/// Returns a text in which one part is another.
std::string with(std::string text, const std::string& part, const std::string& other) {
  return text.replace(text.find(part), part.size(), other);
}

// One for each reason; what is refused, by this reader and that of Python, is in tests/bad_input.
TEST_F(MeshFile, IsRefusedWithAReason) {
  expect_refused("mesh.vtk", ascii_stl, ".stl, .obj or .ply");
  for (const char* name : {"body.obj", "body.ply", "body.stl"}) {
    expect_refused(name, "", "it is empty");
    expect_refused(name, std::string(80, '\0'), "it holds nothing but zeros");
    expect_refused(name, "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 684\n",
                   "it is a pointer of Git LFS");
  }
  expect_refused("text.stl", ascii_stl.substr(0, ascii_stl.rfind("vertex")), "cannot be read");
  expect_refused("nan.stl", with(ascii_stl, "vertex 1 0 0", "vertex nan 0 1"),
                 "holds 'nan' instead of a finite number");
  expect_refused("text.ply", ascii_ply.substr(0, ascii_ply.size() - 3), "ends before the data");
  expect_refused("header.ply", ascii_ply.substr(0, 60), "header");
  expect_refused("points.ply", with(ascii_ply, "element face", "element edge"),
                 "holds no triangles: the PLY file has no element face");
  expect_refused("index.ply", with(ascii_ply, "3 2 1 0", "3 2 1 9"),
                 "face 1 refers to vertex 9; there are 4 vertices");
  expect_refused("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "has no faces");
  expect_refused("w.obj", "v 0 0 0 2\n", "has a vertex of the weight '2'; only 1 is read in line 1");
  expect_refused("nan.obj", "v 0 0 0\nv 0 0 nan\n", "holds 'nan' instead of a finite number in line 2");
  expect_refused("index.obj", obj + "f 1 2 three\n", "holds 'three' instead of an integer");
  for (const auto& [face, vertex] : {std::pair("f 1 2 99", "99"), std::pair("f 1/1 2/1 \\\n0/1", "0/1"),
                                     std::pair("f -1 -2 -6\nv 0 0 0", "-6")})
    expect_refused("index.obj", obj + face + "\n",
                   "face 2 (line 9) refers to vertex " + std::string(vertex) + "; there are 5 vertices");
}

TEST(MeshFormats, ObjFacesMayCountVerticesBackwardsAndReferToLaterOnes) {
  const std::string statements = "f 1 \\\n2//1 3\nv 0 0 0\nv 1 0 0\r\nv 1 1 0\nf -3 -2 -1\r\n";
  const Triangle triangle{Vector3d{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  EXPECT_THAT(read_obj(statements).triangles, ElementsAre(triangle, triangle));
}

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

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
