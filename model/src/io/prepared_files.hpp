#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "numeric/archive.hpp"

namespace fringe::detail {

/// Returns a digest of the library's sources, made by the build: what one state of them has prepared may be
/// something else to another.
const char* sources_digest();

/// A folder of data that take long to prepare, each in a file of its own. A file holds all that its data were
/// prepared from, byte by byte, and is found by it; and which build of the library on which instruction set
/// prepared them, as other ones come to other bits. A file that is damaged, incomplete or of another build
/// counts as none.
class PreparedFiles {
 public:
  /// Makes the folder if there is none.
  /// @throws InputError if it cannot be made, or no files in it.
  explicit PreparedFiles(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }

  /// Returns the data of a kind that were prepared from an input, if they are there.
  std::optional<std::string> find(std::string_view kind, std::string_view input) const;

  /// Keeps data. The file is whole whenever it is there, also where several processes write it at once.
  /// @throws std::runtime_error with the file's name if it cannot be written.
  void keep(std::string_view kind, std::string_view input, std::string_view data) const;

  /// Returns the file of these data, which need not be there.
  std::filesystem::path file(std::string_view kind, std::string_view input) const;

 private:
  std::filesystem::path folder_;
};

/// Reads a value that was prepared from an input before, or prepares and keeps it. Without files it is
/// prepared and not kept.
/// @param value has a function describe (numeric/archive.hpp); `prepare` fills it in
template <typename Value, typename Prepare>
void read_or_prepare(const PreparedFiles* files, std::string_view kind, const std::string& input,
                     Value& value, const Prepare& prepare) {
  if (files == nullptr) {
    prepare();
    return;
  }
  if (const std::optional<std::string> data = files->find(kind, input)) {
    ArchiveReader archive(*data);
    archive(value);
    return;
  }
  prepare();
  files->keep(kind, input, bytes_of(value));
}

}  // namespace fringe::detail
