#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "assessment.hpp"
#include "fringe/error.hpp"
#include "triangle_classes.hpp"

/// The stress program of the exact integral: compares it with quadrature in higher precision on random
/// triangles of every class.
namespace fringe::stress {
namespace {

enum ExitCode { passed = 0, failed = 1, wrong_input = 2 };

struct Request {
  std::size_t count = 100'000;
  std::uint64_t seed = 1;
  std::vector<std::string> classes;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  std::string json;
};

/// Relative errors, and their ratios to the conditioning, of the finite results whose truth is finite and
/// positive; absent when there are none.
struct MethodSummary {
  std::size_t triangles = 0;           ///< triangles to which the method applies
  std::size_t not_finite = 0;          ///< infinite or not a number where the truth is finite
  std::size_t wrong_by_1_percent = 0;  ///< off by more than 1 %, or wrongly 0, infinite or NaN
  std::optional<double> largest_error, largest_over_conditioning, percentile_99_over_conditioning;
};

struct ClassSummary {
  TriangleClass of_class;
  std::size_t truth_failed = 0;
  std::vector<std::pair<std::string, MethodSummary>> methods;
  /// Largest value of error_over_allowed, for each tolerance.
  std::array<double, tolerances.size()> largest_over_allowed{};
};

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
  summary.largest_over_conditioning = quantile(over_conditioning, 1);
  summary.percentile_99_over_conditioning = quantile(over_conditioning, 0.99);
  return summary;
}

Json description(std::optional<double> number) {
  return number ? Json(*number) : Json();
}

Json description(const ClassSummary& summary) {
  Json methods = Json::object();
  for (const auto& [name, method] : summary.methods)
    methods[name] = {
        {"triangles", method.triangles},
        {"not_finite", method.not_finite},
        {"wrong_by_1_percent", method.wrong_by_1_percent},
        {"largest_over_conditioning", description(method.largest_over_conditioning)},
        {"percentile_99_over_conditioning", description(method.percentile_99_over_conditioning)}};
  return {{"name", summary.of_class.name}, {"truth_failed", summary.truth_failed}, {"methods", methods}};
}

ClassSummary summarize(const Assessment& assessment) {
  ClassSummary summary{assessment.of_class, 0, {}, {}};
  for (const Specimen& specimen : assessment.specimens) {
    if (!specimen.truth.converged)
      ++summary.truth_failed;
    for (std::size_t k = 0; k < tolerances.size(); ++k)
      summary.largest_over_allowed[k] =
          std::max(summary.largest_over_allowed[k], error_over_allowed(specimen, k));
  }
  for (const auto& [method, name] : judged)
    summary.methods.emplace_back(name, summarize(assessment, method));
  return summary;
}

/// Writes what the report shows.
void write_json(const std::vector<ClassSummary>& summaries, const std::string& path) {
  Json classes = Json::array();
  for (const ClassSummary& summary : summaries)
    classes.push_back(description(summary));
  std::ofstream file(path);
  file << Json{{"limit", limit}, {"classes", classes}}.dump(4) << '\n';
  file.close();
  if (!file)
    throw std::runtime_error("cannot write " + path);
}

/// Formats the nine numbers of a triangle or a plate without rounding.
template <class Vectors>
std::string hexadecimal(const Vectors& vectors) {
  std::string text;
  for (const Eigen::Vector3d& vector : vectors)
    for (const double component : vector)
      text += fmt::format(" {:a}", component);
  return text;
}

std::string inputs(const Specimen& specimen) {
  const auto& [corner, edge_u, edge_v] = specimen.plate;
  return hexadecimal(specimen.triangle) + hexadecimal(std::vector<Eigen::Vector3d>{corner, edge_u, edge_v});
}

double severity(const Specimen& specimen) {
  return specimen.truth.converged ? *error_of(specimen, Judged::exact) / specimen.conditioning : HUGE_VAL;
}

/// Prints the worst of the triangles that fail, in a form that can be run again.
void print_offenders(const Assessment& assessment) {
  constexpr std::size_t most = 5;
  std::vector<const Specimen*> offenders;
  for (const Specimen& specimen : assessment.specimens)
    if (!passes(specimen, assessment.of_class))
      offenders.push_back(&specimen);
  std::sort(offenders.begin(), offenders.end(),
            [](const Specimen* a, const Specimen* b) { return severity(*a) > severity(*b); });
  if (!offenders.empty())
    fmt::print("{}: {} of {} triangles fail\n", assessment.of_class.name, offenders.size(),
               assessment.specimens.size());
  for (std::size_t i = 0; i < std::min(most, offenders.size()); ++i) {
    const Specimen& specimen = *offenders[i];
    fmt::print(
        "  triangle, corner, edge_u, edge_v:{}\n"
        "  truth {:a}{}, conditioning {:.3g}, batched {:a} (error {:.3g}), alone {:a} (error {:.3g})\n",
        inputs(specimen), specimen.truth.value.high,
        specimen.truth.converged ? "" : " (quadrature did not converge)", specimen.conditioning,
        specimen.batched, relative_error(specimen.batched, specimen.truth), specimen.single,
        relative_error(specimen.single, specimen.truth));
  }
}

std::string shown(std::optional<double> number) {
  return number ? fmt::format("{:.2g}", *number) : "-";
}

constexpr char row[] = "{:<22}{:<9}{:>8}{:>11}{:>10}{:>11}{:>11}{:>10}\n";

void print(const ClassSummary& summary) {
  for (const auto& [name, method] : summary.methods)
    if (method.triangles > 0)
      fmt::print(row, summary.of_class.name, name, method.triangles, method.not_finite,
                 shown(method.largest_error), shown(method.percentile_99_over_conditioning),
                 shown(method.largest_over_conditioning), method.wrong_by_1_percent);
  fmt::print("{:<22}error over what a tolerance allows:", summary.of_class.name);
  for (std::size_t k = 0; k < tolerances.size(); ++k)
    fmt::print("  {:g}: {:.2g}", tolerances[k], summary.largest_over_allowed[k]);
  fmt::print("\n");
  if (summary.truth_failed > 0)
    fmt::print("{:<22}the quadrature failed for {} triangles\n", summary.of_class.name, summary.truth_failed);
  std::fflush(stdout);
}

/// Returns the number of triangles of the i-th class when `count` triangles are distributed over all classes.
std::size_t share(std::size_t count, std::size_t i, std::size_t classes) {
  return count * (i + 1) / classes - count * i / classes;
}

ExitCode run(const Request& request) {
  const std::vector<TriangleClass> known = triangle_classes();
  std::vector<TriangleClass> chosen;
  for (const std::string& name : request.classes) {
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const TriangleClass& c) { return c.name == name; });
    if (found == known.end())
      throw InputError(fmt::format("there is no class '{}'", name));
    chosen.push_back(*found);
  }
  if (chosen.empty())
    chosen = known;

  std::vector<ClassSummary> summaries;
  bool all_pass = true;
  fmt::print(row, "class", "method", "count", "not finite", "largest", "99 %/c", "largest/c", "off 1 %");
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::vector<Group> groups =
        make_triangles(chosen[i].name, share(request.count, i, chosen.size()), request.seed);
    const Assessment assessment = assess(chosen[i], groups, request.threads);
    all_pass = all_pass && std::all_of(assessment.specimens.begin(), assessment.specimens.end(),
                                       [&](const Specimen& s) { return passes(s, chosen[i]); });
    summaries.push_back(summarize(assessment));
    print(summaries.back());
    print_offenders(assessment);
  }
  if (!request.json.empty())
    write_json(summaries, request.json);
  return all_pass ? passed : failed;
}

int command(int argument_count, char** arguments) {
  CLI::App program(
      "Holds the exact integral against quadrature in higher precision, on random triangles of "
      "every class that has broken a formula. Fails when an error is more than 16 times what one "
      "unit in the last place of an input changes (c), or beyond a tolerance asked for.");
  Request request;
  program.add_option("--count", request.count, "Triangles, of all classes together")->capture_default_str();
  program.add_option("--seed", request.seed, "Of the random numbers")->capture_default_str();
  program.add_option("--classes", request.classes, "Names, separated by commas; default: all")
      ->delimiter(',');
  program.add_option("--threads", request.threads, "Default: one for every core")->check(CLI::PositiveNumber);
  program.add_option("--json", request.json, "A file for the summary");
  try {
    program.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? passed : wrong_input;
  }
  return run(request);
}

}  // namespace
}  // namespace fringe::stress

int main(int argument_count, char** arguments) {
  try {
    return fringe::stress::command(argument_count, arguments);
  } catch (const fringe::InputError& error) {
    fmt::print(stderr, "plate_integral_stress: {}\n", error.what());
    return fringe::stress::wrong_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "plate_integral_stress: {}\n", error.what());
    return fringe::stress::failed;
  }
}
