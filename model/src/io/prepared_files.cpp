#include "io/prepared_files.hpp"

#include <atomic>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "fringe/error.hpp"
#include "fringe/version.hpp"
#include "io/input_file.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

namespace fs = std::filesystem;

/// First bytes of a file of prepared data; the number is that of the format.
constexpr std::string_view beginning_of_file = "fringe prepared data 1\n";

/// Returns a hash of 64 bits over the words of some bytes: each step is invertible, so that two texts of
/// which one word differs have different hashes.
std::uint64_t hash_of_words(std::string_view bytes, std::uint64_t hash) {
  /// Odd multiplier, 2⁶⁴ over the golden ratio.
  constexpr std::uint64_t factor = 0x9e3779b97f4a7c15U;
  constexpr unsigned half = 32;
  const auto take = [&](std::uint64_t word) {
    hash = (hash ^ word) * factor;
    hash ^= hash >> half;
  };
  take(bytes.size());
  std::uint64_t word = 0;
  for (; bytes.size() >= sizeof word; bytes.remove_prefix(sizeof word)) {
    std::memcpy(&word, bytes.data(), sizeof word);
    take(word);
  }
  word = 0;
  std::memcpy(&word, bytes.data(), bytes.size());
  take(word);
  return hash;
}

/// Says what prepares the data.
std::string preparer() {
  return fmt::format("{}, {}, {}, {}", version(), sources_digest(), __VERSION__,
                     name_of(available_instruction_sets().back()));
}

/// Writes a file under a temporary name, and then gives it its own. Returns false if that fails.
bool write_whole(const fs::path& file, std::string_view bytes) {
  static std::atomic<unsigned> number = 0;
  const fs::path unfinished =
      file.parent_path() / fmt::format(".{}.{}-{}.unfinished", file.filename().string(), getpid(), number++);
  std::ofstream stream(unfinished, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  std::error_code failure;
  if (stream)
    fs::rename(unfinished, file, failure);
  if (stream && !failure)
    return true;
  fs::remove(unfinished, failure);
  return false;
}

}  // namespace

PreparedFiles::PreparedFiles(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  if (folder_.native().find('\0') == std::string::npos)
    fs::create_directories(folder_, error);
  if (!fs::is_directory(folder_, error) || access(folder_.c_str(), W_OK | X_OK) != 0)
    throw InputError(fmt::format("prepared: {} is no folder that can be written", folder_.string()));
}

fs::path PreparedFiles::file(std::string_view kind, std::string_view input) const {
  return folder_ /
         fmt::format("{}-{:016x}.prepared", kind, hash_of_words(input, hash_of_words(preparer(), 0)));
}

std::optional<std::string> PreparedFiles::find(std::string_view kind, std::string_view input) const {
  const fs::path path = file(kind, input);
  if (!is_file(path))
    return std::nullopt;
  try {
    const std::string content = file_content(path);
    std::string_view rest = content;
    if (!rest.starts_with(beginning_of_file))
      return std::nullopt;
    rest.remove_prefix(beginning_of_file.size());
    std::string known_kind, known_preparer, known_input, data;
    std::uint64_t hash = 0;
    ArchiveReader archive(rest);
    archive(known_kind, known_preparer, known_input, data, hash);
    if (known_kind != kind || known_preparer != preparer() || known_input != input ||
        hash != hash_of_words(data, 0))
      return std::nullopt;
    return data;
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const ArchiveEnds&) {
    return std::nullopt;
  }
}

void PreparedFiles::keep(std::string_view kind, std::string_view input, std::string_view data) const {
  const fs::path path = file(kind, input);
  if (!write_whole(path, std::string(beginning_of_file) + bytes_of(std::string(kind), preparer(),
                                                                   std::string(input), std::string(data),
                                                                   hash_of_words(data, 0))))
    throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace fringe::detail
