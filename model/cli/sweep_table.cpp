#include "sweep_table.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "csv_text.hpp"
#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "fringe/triangulation.hpp"
#include "fringe/version.hpp"

namespace fringe::cli {
namespace {

constexpr const char* column_names =
    "frame,name,reading,method,answered_by,value_F,value_error_F,background_F,background_error_F,change_F,"
    "change_error_F,delta_voltage_V,threshold_F,noticed,reached,key\n";

/// Columns after that of the answering method in the row of a method without an answer, with their commas.
constexpr const char* no_answer = ",,,,,,,,,,,\n";

constexpr std::uint64_t hash_start = 14695981039346656037U, hash_factor = 1099511628211U;

/// Continues a hash over bytes (FNV-1a, 64 bits).
std::uint64_t hashed(std::string_view bytes, std::uint64_t hash = hash_start) {
  for (const char byte : bytes)
    hash = (hash ^ static_cast<unsigned char>(byte)) * hash_factor;
  return hash;
}

/// Returns the bytes of numbers.
std::string_view bytes_of(const double* numbers, std::size_t count) {
  return {reinterpret_cast<const char*>(numbers), count * sizeof(double)};
}

std::string to_string(Noticed noticed) {
  switch (noticed) {
  case Noticed::no:
    return "no";
  case Noticed::yes:
    return "yes";
  case Noticed::unsure:
    return "unsure";
  default:
    return "";
  }
}

Noticed parse_noticed(std::string_view text) {
  for (const Noticed known : {Noticed::no, Noticed::yes, Noticed::unsure})
    if (text == to_string(known))
      return known;
  return Noticed::not_known;
}

/// Compares the size of a change with a threshold; `unsure` if the error decides, or is not known of a method
/// that estimates it.
Noticed noticed(const ReadingAnswer& answer, const std::optional<double>& threshold) {
  const Estimate& change = answer.change;
  if (!threshold || !change.value)
    return Noticed::not_known;
  if (!change.error && !is_integral(method_of(with_method({}, answer.answered_by))))
    return Noticed::unsure;
  const double error = change.error.value_or(0), size = std::abs(*change.value);
  if (size - error > *threshold)
    return Noticed::yes;
  return size + error > *threshold ? Noticed::unsure : Noticed::no;
}

/// Returns by how much the targets lower the output of the divider, if the reading is that of a sensor alone.
std::optional<double> delta_voltage(const Scene& scene, const Reading& reading, const ReadingAnswer& answer) {
  if (!answer.value.value || !answer.background.value || reading.drive != std::vector{reading.sense})
    return std::nullopt;
  for (const Sensor& sensor : scene.sensors)
    if (sensor.name == reading.sense)
      return divider_voltage(sensor, *answer.background.value) - divider_voltage(sensor, *answer.value.value);
  return std::nullopt;
}

std::string text_of(const std::optional<double>& number) {
  return number ? fmt::format("{}", *number) : std::string();
}

/// Returns the beginning of a row.
std::string beginning(std::size_t number, const std::string& frame, const std::string& reading,
                      const std::string& method) {
  return fmt::format("{},{},{},{},", number, csv_field(frame), csv_field(reading), csv_field(method));
}

/// Returns the last but `skipped` field of a row, none of which may be in quotation marks.
std::string_view field_from_end(std::string_view row, int skipped) {
  for (; skipped > 0; --skipped)
    row = row.substr(0, row.rfind(','));
  return row.substr(row.rfind(',') + 1);
}

}  // namespace

const char* const sweep_header = column_names;

FrameRows answered_rows(const Scene& scene, std::size_t number, const std::string& frame,
                        const std::string& method, const Evaluation& answer, const std::string& key) {
  const std::vector<Reading> described = readings(scene);
  FrameRows rows{.text = {}, .noticed = {}, .reached = answer.reached};
  const char* const reached = !states_errors(method_of(with_method({}, method))) ? ""
                              : answer.reached                                   ? "yes"
                                                                                 : "no";
  for (std::size_t k = 0; k < described.size(); ++k) {
    const ReadingAnswer& reading = answer.readings[k];
    rows.noticed.push_back(noticed(reading, described[k].threshold));
    rows.text += fmt::format(
        "{}{},{},{},{},{},{},{},{},{},{},{},{}\n", beginning(number, frame, reading.name, method),
        reading.answered_by, text_of(reading.value.value), text_of(reading.value.error),
        text_of(reading.background.value), text_of(reading.background.error), text_of(reading.change.value),
        text_of(reading.change.error), text_of(delta_voltage(scene, described[k], reading)),
        text_of(described[k].threshold), to_string(rows.noticed.back()), reached, key);
  }
  return rows;
}

FrameRows refused_rows(const Scene& scene, std::size_t number, const std::string& frame,
                       const std::string& method) {
  FrameRows rows;
  for (const Reading& reading : readings(scene)) {
    rows.noticed.push_back(Noticed::not_known);
    rows.text += beginning(number, frame, reading.name, method) + no_answer;
  }
  return rows;
}

EarlierRows::EarlierRows(const std::filesystem::path& file) {
  // A device may have no end.
  if (std::filesystem::exists(file) && !std::filesystem::is_regular_file(file))
    throw InputError(fmt::format("{} is no file that a table could be written to", file.string()));
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line))
    return;
  // A table of another version of this program may be replaced, a user's own file not.
  if (!line.starts_with("frame,name,reading,"))
    throw InputError(
        fmt::format("{} is no table of a sweep, and would be replaced: name another file", file.string()));
  if (line + '\n' != sweep_header)
    return;
  while (std::getline(stream, line))
    lines_.insert(line);
}

std::optional<FrameRows> EarlierRows::find(const Scene& scene, std::size_t number, const std::string& frame,
                                           const std::string& method, const std::string& key) const {
  FrameRows rows;
  for (const Reading& reading : readings(scene)) {
    const std::string begins = beginning(number, frame, reading.name, method);
    const auto row = lines_.lower_bound(begins);
    if (row == lines_.end() || !row->starts_with(begins) || field_from_end(*row, 0) != key)
      return std::nullopt;
    rows.text += *row + '\n';
    rows.reached = rows.reached && field_from_end(*row, 1) != "no";
    rows.noticed.push_back(parse_noticed(field_from_end(*row, 2)));
  }
  return rows;
}

SweepKey::SweepKey(const std::filesystem::path& file, const Scene& scene) : scene_(hashed(version())) {
  std::ifstream stream(file, std::ios::binary);
  scene_ = hashed(std::string(std::istreambuf_iterator<char>(stream), {}), scene_);
  for (const Object& object : scene.objects)
    for (const Triangle& triangle : triangulate(object.shape))
      for (const Eigen::Vector3d& vertex : triangle)
        scene_ = hashed(bytes_of(vertex.data(), 3), scene_);
}

std::string SweepKey::of(const Frame& frame, const MethodRequest& request) const {
  const auto option = [](const auto& given) { return given ? fmt::format("{}", *given) : std::string("-"); };
  std::uint64_t hash =
      hashed(fmt::format("{} {}", request.method.value_or("-"), option(request.rtol)), scene_);
  for (const Eigen::Isometry3d& pose : frame.poses)
    hash = hashed(bytes_of(pose.matrix().data(), 16), hash);
  return fmt::format("{:016x}", hash);
}

}  // namespace fringe::cli
