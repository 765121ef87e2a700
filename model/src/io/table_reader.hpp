#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
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
  TableReader(const toml::table& table, std::string file, std::string prefix, double units_per_metre = 1);

  bool has(std::string_view key) {
    looked_for_.emplace_back(key);
    return table_->contains(key);
  }

  std::string name(std::string_view key);
  /// Returns the names of a list, which has at least one of them and none twice.
  std::vector<std::string> names(std::string_view key);
  std::string text(std::string_view key);
  /// Returns a text that is one of the choices, the first of them when the key is missing.
  std::string choice(std::string_view key, const std::vector<std::string>& choices);
  bool boolean_or(std::string_view key, bool otherwise);
  double number(std::string_view key);
  double positive_number(std::string_view key);
  double positive_number_or(std::string_view key, double otherwise);
  int whole_number_or(std::string_view key, int least, int most, int otherwise);
  std::vector<double> numbers(std::string_view key, std::size_t count);
  /// Returns the points of a list of pairs of lengths.
  std::vector<Eigen::Vector2d> points(std::string_view key);
  Eigen::Vector3d vector(std::string_view key);
  Eigen::Vector3d nonzero_vector(std::string_view key);

  /// Sets the unit of lengths, here and in the tables within.
  void set_units(double per_metre) { units_per_metre_ = per_metre; }
  double units_per_metre() const { return units_per_metre_; }
  // Lengths in metres: the numbers divided by the units per metre, which rounds once, and checked then.
  double length(std::string_view key) { return number(key) / units_per_metre_; }
  double positive_length(std::string_view key);
  std::vector<double> positive_lengths(std::string_view key, std::size_t count);
  Eigen::Vector3d position(std::string_view key) { return vector(key) / units_per_metre_; }
  Eigen::Vector3d edge(std::string_view key);

  TableReader table(std::string_view key);
  /// Returns the tables of an array; none when the key is missing.
  std::vector<TableReader> tables(std::string_view key);

  /// Sets the prefix of messages to the table's name instead of its position in the file.
  void rename(std::string prefix) { prefix_ = std::move(prefix); }

  /// Throws InputError, with these keys, for any other key.
  void allow_only(std::initializer_list<std::string_view> known) const;

  /// Throws InputError, with the keys that were looked for, for a key that was never read.
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
  double units_per_metre_ = 1;
  // Lists, because a scene has many tables of few keys.
  std::vector<std::string> requested_;
  std::vector<std::string> looked_for_;
};

/// Returns the document of a TOML file. Throws InputError when the file cannot be read or is not TOML.
toml::table parse_document(const std::filesystem::path& path);

/// Returns the document of a TOML text; `source` stands for the file in messages. Throws InputError when it
/// is not TOML.
toml::table parse_text(std::string_view text, const std::string& source);

/// Throws InputError for a document of a version of the format other than the first. The version is optional.
void require_known_format(TableReader& root);

/// Reads the unit of the lengths in a document, "m" if there is none.
void read_units(TableReader& root);

/// Composes "FILE:LINE: KEY: REASON"; omits the line when it is 0 and the key when it is empty.
std::string located_message(std::string_view file, unsigned line, std::string_view key,
                            std::string_view reason);

/// Reads a pose from `translation` and `rotation` or `quaternion`. What the table leaves out is as in
/// `otherwise`.
Eigen::Isometry3d read_pose(TableReader& table,
                            const Eigen::Isometry3d& otherwise = Eigen::Isometry3d::Identity());

}  // namespace fringe::detail
