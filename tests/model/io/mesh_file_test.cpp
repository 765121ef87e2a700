#include "fringe/mesh_file.hpp"
#include "io/mesh_words.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "geometry.hpp"
#include "io/mesh_formats.hpp"
#include "temporary_folder.hpp"

/// The words of text mesh files, and the readers of their formats, on any bytes.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

class MeshFile : public test::TemporaryFolder {
 protected:
  void expect_refused(const std::string& name, const std::string& content, const std::string& reason) const {
    try {
      read_mesh_file(write(name, content));
      FAIL() << name << " is accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(reason));
    }
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

template <class Number>
void append_bytes(std::string& target, Number number) {
  static_assert(std::endian::native == std::endian::little);
  const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  target.append(bytes.data(), bytes.size());
}

std::string binary_stl() {
  std::string content(80, '\0');
  append_bytes(content, std::uint32_t{1});
  for (const float number : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 2.F, 0.F, 0.F, 0.F, 3.F, 0.F})
    append_bytes(content, number);
  append_bytes(content, std::uint16_t{0});
  return content;
}

std::string binary_ply() {
  std::string content = ascii_ply.substr(0, ascii_ply.find("0 0 0\n"));
  content.replace(content.find("ascii"), 5, "binary_little_endian");
  for (const float number : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F})
    append_bytes(content, number);
  append_bytes(content, std::uint8_t{4});
  for (const std::int32_t index : {0, 1, 2, 3})
    append_bytes(content, index);
  append_bytes(content, std::uint8_t{3});
  for (const std::int32_t index : {2, 1, 0})
    append_bytes(content, index);
  return content;
}

const std::vector<Triangle> two_faces_of_ply{{Vector3d{0, 0, 0}, {1, 0, 0}, {1, 1, 0}},
                                             {Vector3d{0, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                             {Vector3d{1, 1, 0}, {1, 0, 0}, {0, 0, 0}}};

TEST_F(MeshFile, StlKeepsTheOrderOfTheFile) {
  const std::vector<Triangle> triangles = read_mesh_file(write("two.stl", ascii_stl));
  ASSERT_EQ(triangles.size(), 2U);
  EXPECT_EQ(triangles[0], (Triangle{Vector3d{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}));
  EXPECT_EQ(triangles[1], (Triangle{Vector3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST_F(MeshFile, BinaryStlIsReadWhateverTheCaseOfItsExtension) {
  const std::vector<Triangle> triangles = read_mesh_file(write("one.STL", binary_stl()));
  EXPECT_THAT(triangles, testing::ElementsAre(Triangle{Vector3d{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}));
}

TEST_F(MeshFile, ConvexPolygonsOfObjBecomeFansFromTheirFirstVertexAndLinesAreSkipped) {
  const std::vector<Triangle> triangles = read_mesh_file(write("five.obj", obj));
  const Vector3d a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0), e(0.5, 2, 0);
  EXPECT_THAT(triangles, testing::ElementsAre(Triangle{a, b, c}, Triangle{a, c, e}, Triangle{a, e, d},
                                              Triangle{c, b, a}));
}

TEST_F(MeshFile, PolygonsThatAreNotConvexKeepTheirArea) {
  const std::string corners = "2 0 0\n1 0.2 0\n1 2 0\n0 0 0\n";
  std::string ply = ascii_ply;
  ply.replace(ply.find("face 2"), 6, "face 1");
  EXPECT_DOUBLE_EQ(
      area(read_mesh_file(write("dart.ply", ply.substr(0, ply.find("0 0 0\n")) + corners + "4 0 1 2 3\n"))),
      1.1);
  EXPECT_DOUBLE_EQ(
      area(read_mesh_file(write("dart.obj", "v 2 0 0\nv 1 0.2 0\nv 1 2 0\nv 0 0 0\nf 1 2 3 4\n"))), 1.1);
}

TEST_F(MeshFile, ObjMayHaveWeightsOfOneColoursAndNumbersThatBeginWithTheirPoint) {
  const Triangle triangle{Vector3d{.5, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THAT(read_mesh_file(write("w.obj", "v .5 0 0 1\nv 1 0 0 1.0\nv 0 1 0 0.1 0.2 0.3\nf 1 2 3\n")),
              testing::ElementsAre(triangle));
  expect_refused("w.obj", "v 0 0 0 2\n", "has a vertex of the weight '2'; only 1 is read in line 1");
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

TEST_F(MeshFile, WithoutContentIsToldApart) {
  for (const char* name : {"body.obj", "body.ply", "body.stl"}) {
    expect_refused(name, "", "it is empty");
    expect_refused(name, std::string(80, '\0'), "it holds nothing but zeros");
    expect_refused(name, "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 684\n",
                   "it is a pointer of Git LFS");
  }
}

TEST_F(MeshFile, PlyIsReadAsTextAndAsBytes) {
  EXPECT_EQ(read_mesh_file(write("text.ply", ascii_ply)), two_faces_of_ply);
  EXPECT_EQ(read_mesh_file(write("bytes.ply", binary_ply())), two_faces_of_ply);
}

TEST_F(MeshFile, MustExistAndHaveAKnownExtension) {
  EXPECT_THROW(read_mesh_file(folder() / "missing.stl"), InputError);
  EXPECT_THROW(read_mesh_file(folder()), InputError);
  expect_refused("mesh.vtk", ascii_stl, ".stl, .obj or .ply");
}

TEST_F(MeshFile, MustHaveFaces) {
  std::string ply = ascii_ply;
  expect_refused("points.ply", ply.replace(ply.find("element face"), 12, "element edge"),
                 "holds no triangles: the PLY file has no element face");
  expect_refused("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "has no faces");
}

TEST_F(MeshFile, MustNotBeTruncated) {
  expect_refused("text.stl", ascii_stl.substr(0, ascii_stl.rfind("vertex")), "cannot be read");
  expect_refused("bytes.stl", binary_stl().substr(0, 100), "cannot be read");
  const std::string bytes = binary_ply();
  for (const std::size_t missing : {1U, 13U, 20U, 40U})
    expect_refused("bytes.ply", bytes.substr(0, bytes.size() - missing), "ends before the data");
  for (const std::size_t missing : {3U, 8U, 20U, 40U})
    expect_refused("text.ply", ascii_ply.substr(0, ascii_ply.size() - missing), "ends before the data");
  expect_refused("header.ply", ascii_ply.substr(0, 60), "header");
}

TEST_F(MeshFile, FacesMustReferToVerticesThatExist) {
  expect_refused("index.obj", obj + "f 1 2 99\n",
                 "face 2 (line 9) refers to vertex 99; there are 5 vertices");
  expect_refused("index.obj", obj + "f 1/1 2/1 \\\n0/1\n",
                 "face 2 (line 9) refers to vertex 0/1; there are 5 vertices");
  expect_refused("index.obj", obj + "f -1 -2 -6\nv 0 0 0\n",
                 "face 2 (line 9) refers to vertex -6; there are 5 vertices");
  expect_refused("index.obj", obj + "f 1 2 three\n", "holds 'three' instead of an integer");
  std::string ply = ascii_ply;
  expect_refused("index.ply", ply.replace(ply.find("3 2 1 0"), 7, "3 2 1 9"),
                 "face 1 refers to vertex 9; there are 4 vertices");
}

TEST_F(MeshFile, ObjFacesMayCountVerticesBackwardsAndReferToLaterOnes) {
  const std::string statements = "f 1 \\\n2//1 3\nv 0 0 0\nv 1 0 0\r\nv 1 1 0\nf -3 -2 -1\r\n";
  const Triangle triangle{Vector3d{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  EXPECT_THAT(read_mesh_file(write("index.obj", statements)), testing::ElementsAre(triangle, triangle));
}

TEST_F(MeshFile, MustBeFinite) {
  std::string ply = ascii_ply;
  expect_refused("nan.ply", ply.replace(ply.find("1 1 0"), 5, "nan 1 0"), "");
  expect_refused("nan.obj", "v 0 0 0\nv 0 0 nan\n", "holds 'nan' instead of a finite number in line 2");
  std::string stl = ascii_stl;
  expect_refused("nan.stl", stl.replace(stl.find("vertex 1 0 0"), 12, "vertex nan 0 1"),
                 "holds 'nan' instead of a finite number");
}

TEST_F(MeshFile, MayContainRepeatedAndDegenerateTriangles) {
  const Vector3d a(0, 0, 0), b(1, 0, 0), c(1, 1, 0);
  const std::string faces = "f 1 2 3\nf 1 2 3\nf 1 1 3\nf 2 2 2\n";
  EXPECT_THAT(
      read_mesh_file(write("double.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\n" + faces)),
      testing::ElementsAre(Triangle{a, b, c}, Triangle{a, b, c}, Triangle{a, a, c}, Triangle{b, b, b}));
}

TEST_F(MeshFile, OfRandomBytesIsRefused) {
  std::string garbage = "ply\n";
  for (unsigned i = 0; i < 4000; ++i)
    garbage += static_cast<char>(i * 2654435761U >> 13U);
  for (const char* name : {"garbage.stl", "garbage.obj", "garbage.ply"})
    expect_refused(name, garbage, "mesh file");
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
