#include "io/table_reader.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "io/input_file.hpp"

namespace fringe::detail {
std::string located_message(std::string_view file, unsigned line, std::string_view key,
                            std::string_view reason) {
  std::string message(file);
  if (line > 0)
    message += fmt::format(":{}", line);
  if (!key.empty())
    message += fmt::format(": {}", key);
  return message + fmt::format(": {}", reason);
}

TableReader::TableReader(const toml::table& table, std::string file, std::string prefix,
                         double units_per_metre)
    : table_(&table), file_(std::move(file)), prefix_(std::move(prefix)), units_per_metre_(units_per_metre) {}

void TableReader::fail(std::string_view key, std::string_view reason) const {
  const toml::node* node = table_->get(key);
  const toml::source_region& source =
      (node != nullptr ? *node : static_cast<const toml::node&>(*table_)).source();
  throw InputError(located_message(file_, source.begin.line, prefix_ + std::string(key), reason));
}

const toml::node* TableReader::find(std::string_view key) {
  requested_.emplace_back(key);
  return table_->get(key);
}

const toml::node& TableReader::require(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr)
    fail(key, "is missing");
  return *node;
}

double TableReader::finite(std::string_view key, const toml::node& node) const {
  double value = 0;
  if (const auto* integer = node.as_integer())
    value = static_cast<double>(integer->get());
  else if (const auto* floating = node.as_floating_point())
    value = floating->get();
  else
    fail(key, "must be a number");
  if (!std::isfinite(value))
    fail(key, "must be finite");
  if (std::abs(value) > largest_number)
    fail(key, fmt::format("must be at most {:g}", largest_number));
  return value;
}

std::string TableReader::text(std::string_view key) {
  const auto* value = require(key).as_string();
  if (value == nullptr)
    fail(key, "must be a string");
  return value->get();
}

std::string TableReader::choice(std::string_view key, const std::vector<std::string>& choices) {
  const toml::node* node = find(key);
  if (node == nullptr)
    return choices.front();
  const auto* value = node->as_string();
  if (value == nullptr || std::ranges::find(choices, value->get()) == choices.end())
    fail(key, fmt::format(R"(must be "{}" or "{}")",
                          fmt::join(choices.begin(), std::prev(choices.end()), R"(", ")"), choices.back()));
  return value->get();
}

std::string TableReader::name(std::string_view key) {
  std::string value = text(key);
  if (value.empty())
    fail(key, "must not be empty");
  return value;
}

std::vector<std::string> TableReader::names(std::string_view key) {
  const auto* array = require(key).as_array();
  if (array == nullptr)
    fail(key, "must be a list of strings");
  if (array->empty())
    fail(key, "must not be empty");
  std::vector<std::string> values;
  for (const toml::node& element : *array) {
    const auto* value = element.as_string();
    if (value == nullptr)
      fail(key, "must be a list of strings");
    if (std::ranges::find(values, value->get()) != values.end())
      fail(key, fmt::format(R"("{}" is named twice)", value->get()));
    values.push_back(value->get());
  }
  return values;
}

bool TableReader::boolean_or(std::string_view key, bool otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr)
    return otherwise;
  if (!node->is_boolean())
    fail(key, "must be true or false");
  return node->as_boolean()->get();
}

double TableReader::number(std::string_view key) {
  return finite(key, require(key));
}

double TableReader::positive_number(std::string_view key) {
  const double value = number(key);
  if (value <= 0)
    fail(key, "must be greater than zero");
  return value;
}

double TableReader::positive_number_or(std::string_view key, double otherwise) {
  return find(key) == nullptr ? otherwise : positive_number(key);
}

int TableReader::whole_number_or(std::string_view key, int least, int most, int otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr)
    return otherwise;
  if (!node->is_integer())
    fail(key, "must be a whole number");
  const std::int64_t value = node->as_integer()->get();
  if (value < least)
    fail(key, fmt::format("must be at least {}", least));
  if (value > most)
    fail(key, fmt::format("must be at most {}", most));
  return static_cast<int>(value);
}

std::vector<double> TableReader::numbers(std::string_view key, std::size_t count) {
  const auto* array = require(key).as_array();
  if (array == nullptr || array->size() != count)
    fail(key, fmt::format("must be an array of {} numbers", count));
  std::vector<double> values;
  for (const toml::node& element : *array)
    values.push_back(finite(key, element));
  return values;
}

double TableReader::positive_length(std::string_view key) {
  const double value = length(key);
  if (value <= 0)
    fail(key, "must be greater than zero");
  return value;
}

std::vector<double> TableReader::positive_lengths(std::string_view key, std::size_t count) {
  std::vector<double> values = numbers(key, count);
  for (double& value : values) {
    value /= units_per_metre_;
    if (value <= 0)
      fail(key, "must be greater than zero");
  }
  return values;
}

std::vector<Eigen::Vector2d> TableReader::points(std::string_view key) {
  const auto* array = require(key).as_array();
  if (array == nullptr)
    fail(key, "must be an array of [x, y]");
  std::vector<Eigen::Vector2d> values;
  for (const toml::node& element : *array) {
    const auto* pair = element.as_array();
    const std::string place = fmt::format("{}[{}]", key, values.size());
    if (pair == nullptr || pair->size() != 2)
      fail(place, "must be an array of 2 numbers");
    values.emplace_back(Eigen::Vector2d(finite(place, *pair->get(0)), finite(place, *pair->get(1))) /
                        units_per_metre_);
  }
  return values;
}

Eigen::Vector3d TableReader::vector(std::string_view key) {
  return Eigen::Vector3d(numbers(key, 3).data());
}

Eigen::Vector3d TableReader::nonzero_vector(std::string_view key) {
  Eigen::Vector3d value = vector(key);
  if (value.isZero(0))
    fail(key, "must not be zero");
  return value;
}

Eigen::Vector3d TableReader::edge(std::string_view key) {
  Eigen::Vector3d value = position(key);
  if (value.isZero(0))
    fail(key, "must not be zero");
  return value;
}

TableReader TableReader::table(std::string_view key) {
  const auto* value = require(key).as_table();
  if (value == nullptr)
    fail(key, "must be a table");
  return {*value, file_, fmt::format("{}{}.", prefix_, key), units_per_metre_};
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr)
    return {};
  const auto* array = node->as_array();
  if (array == nullptr)
    fail(key, "must be an array of tables");
  std::vector<TableReader> readers;
  for (const toml::node& element : *array) {
    if (!element.is_table())
      fail(key, "must be an array of tables");
    readers.emplace_back(*element.as_table(), file_, fmt::format("{}{}[{}].", prefix_, key, readers.size()),
                         units_per_metre_);
  }
  return readers;
}

void TableReader::allow_only(std::initializer_list<std::string_view> known) const {
  for (const auto& [key, node] : *table_)
    if (std::ranges::find(known, key.str()) == known.end())
      fail(key.str(), fmt::format("is not a known key; there are {}", fmt::join(known, ", ")));
}

void TableReader::finish() const {
  for (const auto& [key, node] : *table_) {
    if (std::ranges::find(requested_, key.str()) != requested_.end())
      continue;
    Names known(requested_.begin(), requested_.end());
    known.insert(looked_for_.begin(), looked_for_.end());
    fail(key.str(), fmt::format("is not a known key; there are {}", fmt::join(known, ", ")));
  }
}

toml::table parse_document(const std::filesystem::path& path) {
  if (!is_file(path))
    throw InputError(located_message(path.string(), 0, "", "the file does not exist or is not a file"));
  return parse_text(file_content(path), path.string());
}

toml::table parse_text(std::string_view text, const std::string& source) {
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(located_message(source, error.source().begin.line, "", error.description()));
  }
}

void require_known_format(TableReader& root) {
  constexpr int known = 1, most_formats = 1'000'000;
  const int format = root.whole_number_or("format", 1, most_formats, known);
  if (format != known)
    root.fail("format", fmt::format("is {}, and this program knows {} only", format, known));
}

void read_units(TableReader& root) {
  constexpr double millimetres_per_metre = 1000;
  if (root.choice("units", {"m", "mm"}) == "mm")
    root.set_units(millimetres_per_metre);
}

namespace {

using Eigen::Vector3d;

Eigen::Isometry3d read_quaternion(TableReader& table, const Vector3d& translation) {
  const std::vector<double> wxyz = table.numbers("quaternion", 4);
  const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (quaternion.coeffs().isZero(0))
    table.fail("quaternion", "must not be zero");
  return pose_from_quaternion(quaternion, translation);
}

}  // namespace

Eigen::Isometry3d read_pose(TableReader& table, const Eigen::Isometry3d& otherwise) {
  const Vector3d translation =
      table.has("translation") ? table.position("translation") : Vector3d(otherwise.translation());
  if (table.has("quaternion")) {
    if (table.has("rotation"))
      table.fail("quaternion", "cannot be combined with rotation");
    return read_quaternion(table, translation);
  }
  if (!table.has("rotation")) {
    Eigen::Isometry3d moved = otherwise;
    moved.translation() = translation;
    return moved;
  }
  TableReader rotation = table.table("rotation");
  // Before a key is missed: other forms of a rotation have other keys.
  rotation.allow_only({"axis", "degrees", "quaternion"});
  Eigen::Isometry3d pose;
  if (rotation.has("quaternion")) {
    pose = read_quaternion(rotation, translation);
  } else {
    const Vector3d axis = rotation.nonzero_vector("axis");
    pose = pose_from_axis(axis, rotation.number("degrees"), translation);
  }
  rotation.finish();
  return pose;
}

}  // namespace fringe::detail
