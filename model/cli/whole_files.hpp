#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace fringe::cli {

/// A temporary file or folder, which is removed with its contents on destruction.
class Unfinished {
 public:
  explicit Unfinished(std::filesystem::path path);
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
  ~Unfinished();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Makes a folder and those above it; on destruction it removes what it made, unless they are kept.
class MissingFolders {
 public:
  /// Throws std::runtime_error when a folder cannot be made.
  explicit MissingFolders(const std::filesystem::path& folder);
  MissingFolders(const MissingFolders&) = delete;
  MissingFolders& operator=(const MissingFolders&) = delete;
  ~MissingFolders();

  void keep() { made_.clear(); }

 private:
  std::filesystem::path made_;  ///< the highest of them
};

/// Returns the path of the temporary file or folder that later takes a name in its folder.
std::filesystem::path unfinished_path(const std::filesystem::path& target);

/// Writes a temporary file that is to take the place of `target`, which the std::runtime_error names that is
/// thrown when it cannot be written.
void write_bytes(const std::filesystem::path& path, const std::string& bytes,
                 const std::filesystem::path& target);

/// Gives a temporary file its own name. Throws std::runtime_error when that cannot be.
void rename_to(const std::filesystem::path& path, const std::filesystem::path& target);

/// Throws std::runtime_error when a file of this name cannot be written in its folder, before minutes are
/// spent on what it is to hold.
void expect_writable(const std::filesystem::path& target);

/// Writes files under temporary names, and gives them their own when all are written, so that no unfinished
/// file is left. Existing files are replaced. Throws std::runtime_error when one cannot be written.
void write_whole(const std::map<std::filesystem::path, std::string>& files);

}  // namespace fringe::cli
