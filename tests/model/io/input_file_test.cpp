#include "io/input_file.hpp"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "temporary_folder.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

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
