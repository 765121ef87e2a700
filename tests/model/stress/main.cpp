#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "assessment.hpp"
#include "fringe/error.hpp"
#include "summary.hpp"
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

void print(const ClassSummary& summary) {
  for (const auto& [name, method] : summary.methods)
    if (method.triangles > 0)
      fmt::print("{:<22}{:<9}{:>8}{:>11}{:>10}{:>10}{:>11}{:>11}{:>11}{:>10}\n", summary.of_class.name, name,
                 method.triangles, method.not_finite, shown(method.median_error), shown(method.largest_error),
                 shown(method.median_over_conditioning), shown(method.percentile_99_over_conditioning),
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

  const auto start = std::chrono::steady_clock::now();
  Summary summary{request.count, request.seed, 0, {}};
  bool all_pass = true;
  fmt::print("{:<22}{:<9}{:>8}{:>11}{:>10}{:>10}{:>11}{:>11}{:>11}{:>10}\n", "class", "method", "count",
             "not finite", "median", "largest", "median/c", "99 %/c", "largest/c", "off 1 %");
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::vector<Group> groups =
        make_triangles(chosen[i].name, share(request.count, i, chosen.size()), request.seed);
    const Assessment assessment = assess(chosen[i], groups, request.threads);
    all_pass = all_pass && std::all_of(assessment.specimens.begin(), assessment.specimens.end(),
                                       [&](const Specimen& s) { return passes(s, chosen[i]); });
    summary.classes.push_back(summarize(assessment));
    print(summary.classes.back());
    print_offenders(assessment);
  }
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!request.json.empty())
    write_json(summary, request.json);
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
