#include "summary.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <rapidjson/prettywriter.h>
#include <rapidjson/stringbuffer.h>

namespace fringe::stress {
namespace {

using Writer = rapidjson::PrettyWriter<rapidjson::StringBuffer>;

/// Returns the quantile: the smallest member that at least this share of all members do not exceed.
std::optional<double> quantile(std::vector<double>& numbers, double share) {
  if (numbers.empty())
    return std::nullopt;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(numbers.size())));
  const auto member = numbers.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(numbers.begin(), member, numbers.end());
  return *member;
}

MethodSummary summarize(const Assessment& assessment, Judged method) {
  MethodSummary summary;
  std::vector<double> errors, over_conditioning;
  for (const Specimen& specimen : assessment.specimens) {
    const std::optional<double> error = error_of(specimen, method);
    if (!error)
      continue;
    ++summary.triangles;
    if (!(*error <= 0.01))
      ++summary.wrong_by_1_percent;
    const double truth = specimen.truth.value.high;
    if (truth == 0 || !std::isfinite(truth))
      continue;
    if (!std::isfinite(*error)) {
      ++summary.not_finite;
      continue;
    }
    errors.push_back(*error);
    over_conditioning.push_back(*error / specimen.conditioning);
  }
  summary.largest_error = quantile(errors, 1);
  summary.median_error = quantile(errors, 0.5);
  summary.largest_over_conditioning = quantile(over_conditioning, 1);
  summary.percentile_99_over_conditioning = quantile(over_conditioning, 0.99);
  summary.median_over_conditioning = quantile(over_conditioning, 0.5);
  return summary;
}

void write(Writer& writer, const char* key, std::size_t number) {
  writer.Key(key);
  writer.Uint64(number);
}

void write(Writer& writer, const char* key, std::optional<double> number) {
  writer.Key(key);
  if (number)
    writer.Double(*number);
  else
    writer.Null();
}

void write(Writer& writer, const MethodSummary& method) {
  writer.StartObject();
  write(writer, "triangles", method.triangles);
  write(writer, "not_finite", method.not_finite);
  write(writer, "largest_error", method.largest_error);
  write(writer, "median_error", method.median_error);
  write(writer, "largest_over_conditioning", method.largest_over_conditioning);
  write(writer, "median_over_conditioning", method.median_over_conditioning);
  write(writer, "percentile_99_over_conditioning", method.percentile_99_over_conditioning);
  write(writer, "wrong_by_1_percent", method.wrong_by_1_percent);
  writer.EndObject();
}

void write(Writer& writer, const ClassSummary& summary) {
  writer.StartObject();
  writer.Key("name");
  writer.String(summary.of_class.name.c_str());
  write(writer, "triangles", summary.triangles);
  writer.Key("well_behaved");
  writer.Bool(summary.of_class.well_behaved);
  write(writer, "truth_failed", summary.truth_failed);
  writer.Key("methods");
  writer.StartObject();
  for (const auto& [name, method] : summary.methods) {
    writer.Key(name.c_str());
    write(writer, method);
  }
  writer.EndObject();
  writer.Key("error_over_allowed");
  writer.StartObject();
  for (std::size_t k = 0; k < tolerances.size(); ++k)
    write(writer, fmt::format("{}", tolerances[k]).c_str(), std::optional(summary.largest_over_allowed[k]));
  writer.EndObject();
  writer.EndObject();
}

std::string to_json(const Summary& summary) {
  rapidjson::StringBuffer buffer;
  Writer writer(buffer);
  writer.StartObject();
  write(writer, "count", summary.count);
  writer.Key("seed");
  writer.Uint64(summary.seed);
  write(writer, "seconds", std::optional<double>(summary.seconds));
  write(writer, "limit", std::optional<double>(limit));
  writer.Key("classes");
  writer.StartArray();
  for (const ClassSummary& of_class : summary.classes)
    write(writer, of_class);
  writer.EndArray();
  writer.EndObject();
  return buffer.GetString();
}

}  // namespace

ClassSummary summarize(const Assessment& assessment) {
  ClassSummary summary{assessment.of_class, assessment.specimens.size(), 0, {}, {}};
  for (const Specimen& specimen : assessment.specimens) {
    if (!specimen.truth.converged)
      ++summary.truth_failed;
    for (std::size_t k = 0; k < tolerances.size(); ++k)
      summary.largest_over_allowed[k] =
          std::max(summary.largest_over_allowed[k], error_over_allowed(specimen, k));
  }
  for (const Judged method : judged)
    summary.methods.emplace_back(name_of(method), summarize(assessment, method));
  return summary;
}

void write_json(const Summary& summary, const std::string& path) {
  const std::string temporary = path + ".part";
  std::ofstream file(temporary);
  file << to_json(summary) << '\n';
  file.close();
  if (!file)
    throw std::runtime_error("cannot write " + temporary);
  std::filesystem::rename(temporary, path);
}

}  // namespace fringe::stress
