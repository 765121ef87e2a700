#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace fringe::cli {

/// A ZIP archive in memory, whose files may have sizes of 64 bits: minizip does not read these.
class Archive {
 public:
  /// Reads the list of the files; throws InputError if the bytes are no archive.
  explicit Archive(std::string bytes);

  /// Returns the content of a file by its name, with or without a slash before it and in letters of any case;
  /// nothing if there is none. Throws InputError if it is damaged.
  std::optional<std::string> content(std::string_view name) const;

 private:
  struct Entry {
    std::uint64_t offset;
    std::uint64_t packed;  ///< bytes
    std::uint64_t size;    ///< bytes
    std::uint32_t checksum;
    std::uint16_t method;
  };

  void read_entries(std::uint64_t begin, std::uint64_t count);

  std::string bytes_;
  std::map<std::string, Entry> entries_;  ///< by names in small letters
};

}  // namespace fringe::cli
