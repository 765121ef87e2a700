#include "summary.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace fringe::stress {
namespace {

using Json = nlohmann::ordered_json;

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

Json description(std::optional<double> number) {
  return number ? Json(*number) : Json();
}

Json description(const MethodSummary& method) {
  return {{"triangles", method.triangles},
          {"not_finite", method.not_finite},
          {"largest_error", description(method.largest_error)},
          {"median_error", description(method.median_error)},
          {"largest_over_conditioning", description(method.largest_over_conditioning)},
          {"median_over_conditioning", description(method.median_over_conditioning)},
          {"percentile_99_over_conditioning", description(method.percentile_99_over_conditioning)},
          {"wrong_by_1_percent", method.wrong_by_1_percent}};
}

Json description(const ClassSummary& summary) {
  Json methods = Json::object();
  for (const auto& [name, method] : summary.methods)
    methods[name] = description(method);
  Json over_allowed = Json::object();
  for (std::size_t k = 0; k < tolerances.size(); ++k)
    over_allowed[fmt::format("{}", tolerances[k])] = summary.largest_over_allowed[k];
  return {{"name", summary.of_class.name},
          {"triangles", summary.triangles},
          {"well_behaved", summary.of_class.well_behaved},
          {"truth_failed", summary.truth_failed},
          {"methods", methods},
          {"error_over_allowed", over_allowed}};
}

std::string to_json(const Summary& summary) {
  Json classes = Json::array();
  for (const ClassSummary& of_class : summary.classes)
    classes.push_back(description(of_class));
  const Json document{{"count", summary.count},
                      {"seed", summary.seed},
                      {"seconds", summary.seconds},
                      {"limit", limit},
                      {"classes", classes}};
  return document.dump(4);
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
