#include "import/archive.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "fringe/error.hpp"

namespace fringe::cli {
namespace {

constexpr std::uint16_t stored = 0, deflated = 8;
/// In place of a number that is given elsewhere, with 64 bits.
constexpr std::uint64_t elsewhere_16 = 0xFFFF, elsewhere_32 = 0xFFFFFFFF;

/// Takes numbers, the smallest byte first, from a part of an archive. Throws InputError at its end.
class Fields {
 public:
  Fields(std::string_view bytes, std::uint64_t begin)
      : rest_(bytes.substr(std::min<std::uint64_t>(begin, bytes.size()))) {}

  std::string_view take(std::uint64_t size) {
    if (size > rest_.size())
      throw InputError("is a damaged archive: it ends early");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  std::uint64_t number(std::size_t size) {
    const std::string_view taken = take(size);
    std::uint64_t value = 0;
    for (std::size_t i = size; i-- > 0;)
      value = value << 8U | static_cast<unsigned char>(taken[i]);
    return value;
  }

  bool empty() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

/// Returns a name as files are looked for: in small letters, and without a slash before it.
std::string key_of(std::string_view name) {
  name.remove_prefix(std::min(name.find_first_not_of('/'), name.size()));
  std::string key(name);
  std::transform(key.begin(), key.end(), key.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return key;
}

/// Inflates data of a known size; returns nothing if they are damaged.
std::optional<std::string> inflated(std::string packed, std::uint64_t size) {
  constexpr int without_header = -MAX_WBITS;
  constexpr std::uint64_t largest_ratio = 1040;  // Of deflation, which bounds what a damaged size asks for.
  constexpr auto most = std::numeric_limits<uInt>::max();
  if (packed.size() > most || size > most || size / largest_ratio > packed.size())
    return std::nullopt;
  std::string content(size, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, without_header) != Z_OK)
    return std::nullopt;
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(content.data());
  stream.avail_out = static_cast<uInt>(content.size());
  const int ending = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  return ending == Z_STREAM_END && stream.avail_out == 0 ? std::optional(std::move(content)) : std::nullopt;
}

}  // namespace

Archive::Archive(std::string bytes) : bytes_(std::move(bytes)) {
  constexpr std::uint64_t locator_size = 20;
  const std::size_t end = bytes_.rfind("PK\5\6");
  if (end == std::string::npos)
    throw InputError("is not an archive, or ends early");
  Fields fields(bytes_, end + 10);
  std::uint64_t count = fields.number(2);
  fields.take(4);
  std::uint64_t begin = fields.number(4);
  if ((count == elsewhere_16 || begin == elsewhere_32) && end >= locator_size) {
    Fields locator(bytes_, end - locator_size);
    if (locator.take(4) == "PK\6\7") {
      locator.take(4);
      Fields wide(bytes_, locator.number(8) + 32);
      count = wide.number(8);
      wide.take(8);
      begin = wide.number(8);
    }
  }
  read_entries(begin, count);
}

void Archive::read_entries(std::uint64_t begin, std::uint64_t count) {
  Fields fields(bytes_, begin);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (fields.take(4) != "PK\1\2")
      throw InputError("is a damaged archive: its list of files is not where it should be");
    fields.take(6);
    Entry entry{};
    entry.method = static_cast<std::uint16_t>(fields.number(2));
    fields.take(4);
    entry.checksum = static_cast<std::uint32_t>(fields.number(4));
    entry.packed = fields.number(4);
    entry.size = fields.number(4);
    const std::uint64_t name_size = fields.number(2), extra_size = fields.number(2),
                        comment_size = fields.number(2);
    fields.take(8);
    entry.offset = fields.number(4);
    const std::string_view name = fields.take(name_size);
    Fields extra(fields.take(extra_size), 0);
    fields.take(comment_size);
    while (!extra.empty()) {
      constexpr std::uint64_t wide_sizes = 1;
      const std::uint64_t kind = extra.number(2);
      Fields content(extra.take(extra.number(2)), 0);
      if (kind != wide_sizes)
        continue;
      for (std::uint64_t* given : {&entry.size, &entry.packed, &entry.offset})
        if (*given == elsewhere_32)
          *given = content.number(8);
    }
    entries_.emplace(key_of(name), entry);
  }
}

std::optional<std::string> Archive::content(std::string_view name) const {
  const auto found = entries_.find(key_of(name));
  if (found == entries_.end())
    return std::nullopt;
  const Entry& entry = found->second;
  Fields fields(bytes_, entry.offset);
  fields.take(26);
  const std::uint64_t name_size = fields.number(2), extra_size = fields.number(2);
  fields.take(name_size + extra_size);
  const std::string_view packed = fields.take(entry.packed);
  std::optional<std::string> content;
  if (entry.method == stored && entry.packed == entry.size)
    content = packed;
  else if (entry.method == deflated)
    content = inflated(std::string(packed), entry.size);
  const auto checksum = [](const std::string& text) {
    return crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size());
  };
  if (!content || checksum(*content) != entry.checksum)
    throw InputError(fmt::format("its part {} is damaged", name));
  return content;
}

}  // namespace fringe::cli
