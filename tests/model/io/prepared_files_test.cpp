#include "io/input_file.hpp"
#include "io/prepared_files.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "temporary_folder.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class PreparedFilesTest : public test::TemporaryFolder {
 protected:
  const fs::path kept_in = folder() / "prepared files" / "of a test";
  const std::string data = std::string("data that took long") + '\0' + "to prepare";
};

TEST_F(PreparedFilesTest, FindTheDataOfAKindAndAnInputAndNoOther) {
  const PreparedFiles files(kept_in);
  EXPECT_EQ(files.find("machine", "input"), std::nullopt);
  files.keep("machine", "input", data);
  EXPECT_EQ(PreparedFiles(kept_in).find("machine", "input"), data);
  EXPECT_EQ(files.find("link", "input"), std::nullopt);
  EXPECT_EQ(files.find("machine", "Input"), std::nullopt);
  files.keep("machine", "input", "other data");
  EXPECT_EQ(files.find("machine", "input"), "other data");
  EXPECT_EQ(std::distance(fs::directory_iterator(kept_in), {}), 1);
}

TEST_F(PreparedFilesTest, CompareTheWholeInputAndNotItsHash) {
  const PreparedFiles files(kept_in);
  files.keep("machine", "input", data);
  fs::rename(files.file("machine", "input"), files.file("machine", "another input"));
  EXPECT_EQ(files.find("machine", "another input"), std::nullopt);
}

TEST_F(PreparedFilesTest, DamagedTruncatedAndForeignFilesCountAsNone) {
  const PreparedFiles files(kept_in);
  files.keep("machine", "input", data);
  const fs::path file = files.file("machine", "input");
  const std::string whole = content(file);
  for (std::size_t k = 0; k < whole.size(); ++k) {
    std::string damaged = whole;
    damaged[k] = static_cast<char>(damaged[k] ^ 1);
    write(file, damaged);
    ASSERT_EQ(files.find("machine", "input"), std::nullopt) << "byte " << k;
    write(file, whole.substr(0, k));
    ASSERT_EQ(files.find("machine", "input"), std::nullopt) << "length " << k;
  }
  write(file, "a text");
  EXPECT_EQ(files.find("machine", "input"), std::nullopt);
  write(file, whole);
  EXPECT_EQ(files.find("machine", "input"), data);
}

TEST_F(PreparedFilesTest, AFolderThatCannotBeIsRefusedByName) {
  fs::create_directories(kept_in.parent_path());
  write(kept_in, "a file");
  EXPECT_THAT(
      [&] { const PreparedFiles files(kept_in); },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("of a test is no folder that can be written")));
  EXPECT_EQ(content(kept_in), "a file");
}

TEST_F(PreparedFilesTest, AFileThatCannotBeWrittenIsNamed) {
  const PreparedFiles files(kept_in);
  fs::create_directories(files.file("machine", "input") / "in its place");
  EXPECT_THAT([&] { files.keep("machine", "input", data); },
              testing::ThrowsMessage<std::runtime_error>(
                  testing::StrEq(files.file("machine", "input").string() + ": cannot be written")));
  EXPECT_EQ(std::distance(fs::directory_iterator(kept_in), {}), 1);
}

/// A value that consists of others.
struct Described {
  std::vector<double> numbers;
  std::string text;
  std::optional<double> number;

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.numbers, self.text, self.number);
  }
};

TEST_F(PreparedFilesTest, AValueIsPreparedOnce) {
  const PreparedFiles files(kept_in);
  for (int run = 0; run < 3; ++run) {
    Described value;
    bool is_prepared = false;
    read_or_prepare(run < 2 ? &files : nullptr, "value", "input", value, [&] {
      value.numbers = {1, 2, 0.1};
      value.text = "text";
      value.number = 3;
      is_prepared = true;
    });
    EXPECT_EQ(is_prepared, run != 1);
    EXPECT_EQ(value.numbers, (std::vector<double>{1, 2, 0.1}));
    EXPECT_EQ(value.text, "text");
    EXPECT_EQ(value.number, 3);
  }
}

class InputFile : public test::TemporaryFolder {};

TEST_F(InputFile, IsReadByteByByte) {
  const std::string bytes("a\r\n\0\xff\n", 6);
  const std::filesystem::path path = write("bytes", bytes);
  EXPECT_TRUE(is_file(path));
  EXPECT_EQ(file_content(path), bytes);
  EXPECT_EQ(file_content(write("empty", "")), "");
}

TEST_F(InputFile, IsNoFolderDeviceLoopOrNothing) {
  EXPECT_FALSE(is_file(folder()));
  EXPECT_FALSE(is_file(folder() / "missing"));
  EXPECT_FALSE(is_file("/dev/zero"));
  EXPECT_FALSE(is_file(std::string("a\0b", 3)));
  std::filesystem::create_symlink(folder() / "loop", folder() / "loop");
  EXPECT_FALSE(is_file(folder() / "loop"));
  EXPECT_THROW(file_content(folder() / "missing"), InputError);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
