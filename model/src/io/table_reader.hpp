#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <toml++/toml.h>

/// Reader of a TOML table key by key, with errors that give file, line, key and reason.
namespace fringe::detail {

/// Largest magnitude of a number in a scene. Beyond it, products of lengths in the integrals may overflow.
constexpr double largest_number = 1e30;

using Names = std::set<std::string, std::less<>>;

/// Wraps one table of a scene file. Every read names its key; a key that was never named is unknown, which
/// `finish` reports. Reads without a default throw InputError when the key is missing, and all reads throw
/// when the value has the wrong type.
class TableReader {
 public:
  /// `prefix` stands before every key in messages, for instance `object "target": `.
  TableReader(const toml::table& table, std::string file, std::string prefix);

  bool has(std::string_view key) const { return table_->contains(key); }

  std::string name(std::string_view key);
  /// Returns the names of a list, which has at least one of them and none twice.
  std::vector<std::string> names(std::string_view key);
  std::string text(std::string_view key);
  bool boolean_or(std::string_view key, bool otherwise);
  double number(std::string_view key);
  double positive_number(std::string_view key);
  double positive_number_or(std::string_view key, double otherwise);
  int whole_number_or(std::string_view key, int least, int most, int otherwise);
  std::vector<double> numbers(std::string_view key, std::size_t count);
  std::vector<double> positive_numbers(std::string_view key, std::size_t count);
  /// Returns the points of a list of pairs of numbers.
  std::vector<Eigen::Vector2d> points(std::string_view key);
  Eigen::Vector3d vector(std::string_view key);
  Eigen::Vector3d vector_or_zero(std::string_view key);
  Eigen::Vector3d nonzero_vector(std::string_view key);

  TableReader table(std::string_view key);
  /// Returns the tables of an array; none when the key is missing.
  std::vector<TableReader> tables(std::string_view key);

  /// Sets the prefix of messages to the table's name instead of its position in the file.
  void rename(std::string prefix) { prefix_ = std::move(prefix); }

  /// Throws InputError for a key that was never read.
  void finish() const;

  /// Throws InputError about a key of this table, or about the table itself when the table has no such key.
  [[noreturn]] void fail(std::string_view key, std::string_view reason) const;

 private:
  const toml::node* find(std::string_view key);
  const toml::node& require(std::string_view key);
  double finite(std::string_view key, const toml::node& node) const;

  const toml::table* table_;
  std::string file_;
  std::string prefix_;
  Names requested_;
};

/// Returns the document of a TOML file. Throws InputError when the file cannot be read or is not TOML.
toml::table parse_document(const std::filesystem::path& path);

/// Returns the document of a TOML text; `source` stands for the file in messages. Throws InputError when it
/// is not TOML.
toml::table parse_text(std::string_view text, const std::string& source);

/// Throws InputError for a document of a version of the format other than the first. The version is optional.
void require_known_format(TableReader& root);

/// Composes "FILE:LINE: KEY: REASON"; omits the line when it is 0 and the key when it is empty.
std::string located_message(std::string_view file, unsigned line, std::string_view key,
                            std::string_view reason);

}  // namespace fringe::detail
