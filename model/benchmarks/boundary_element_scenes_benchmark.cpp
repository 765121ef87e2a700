/// Measures boundary elements as users meet them, on two processors: scenes from two plates to a whole
/// machine, the growth of time and memory with the number of panels, and the capacities of the five regular
/// polyhedra. Times are those of a clock, each from one computation in a process of its own. Prints the
/// tables of model/MEASUREMENTS.md.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "bem/panel_system.hpp"
#include "boundary_element_scenes.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/interruption.hpp"
#include "surface/bodies.hpp"

namespace {

using namespace fringe;
using namespace fringe::benchmarks;

constexpr std::size_t threads = 2;

/// The accuracy asked for of the regular polyhedra, and the number of panels that it may take.
constexpr double rtol_of_solids = 2.5e-4;
constexpr double rtol_of_box = 1e-6;
constexpr std::size_t most_unknowns_of_solids = 100'000;

/// The answer of a computation, its time and the largest memory of its process.
template <class Answer>
struct Measured {
  Answer answer;
  double seconds;
  double mebibytes;
};

/// Computes in a process of its own: the largest memory of a process never decreases, so that one process
/// cannot tell that of several computations. Call it before this process starts threads, which a copy of it
/// would not have.
template <class Computation>
auto in_own_process(const Computation& compute) {
  using Result = Measured<decltype(compute())>;
  static_assert(std::is_trivially_copyable_v<Result>);
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0)
    throw std::runtime_error("no pipe to a process that computes");
  // Both processes would print what is still in the buffer.
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0)
    throw std::runtime_error("no process to compute in");
  if (child == 0) {
    bool written = false;
    try {
      const auto start = std::chrono::steady_clock::now();
      Result result{compute(), 0, 0};
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      result.seconds = elapsed.count();
      written = write(pipe_ends[1], &result, sizeof result) == sizeof result;
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
    }
    _exit(written ? 0 : 1);
  }
  close(pipe_ends[1]);
  Result result{};
  const bool is_read = read(pipe_ends[0], &result, sizeof result) == sizeof result;
  close(pipe_ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (!is_read)
    throw std::runtime_error("a computation has no answer");
  /// Linux counts the memory in kibibytes.
  constexpr double kibibytes_in_mebibyte = 1024;
  result.mebibytes = static_cast<double>(usage.ru_maxrss) / kibibytes_in_mebibyte;
  return result;
}

/// What is known of one scene after it was solved.
struct SceneAnswer {
  std::size_t unknowns;
  /// Largest stated error of a reading's change, relative to the change; of a value where there is no target.
  double stated;
};

SceneAnswer solve(const TimedScene& timed) {
  const auto start = std::chrono::steady_clock::now();
  const InterruptionScope scope([start, &timed] {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    return timed.most_seconds.has_value() && elapsed.count() > *timed.most_seconds;
  });
  const MaxwellMatrix matrix =
      maxwell(timed.scene, {.rtol = timed.rtol, .entries = Entries::of_readings, .threads = threads});
  SceneAnswer answer{matrix.unknowns, 0};
  const bool has_target =
      std::ranges::any_of(timed.scene.objects, [](const Object& object) { return object.target; });
  for (const ReadingAnswer& reading : matrix.readings) {
    const Estimate& asked = has_target ? reading.change : reading.value;
    answer.stated = std::max(answer.stated, asked.error.value() / std::abs(asked.value.value()));
  }
  return answer;
}

void measure_scenes() {
  fmt::print("\n| | rtol | unknowns | stated error of readings, % | s | MiB |\n|---|---|---|---|---|---|\n");
  for (const TimedScene& timed : timed_scenes()) {
    const auto [answer, seconds, mebibytes] = in_own_process([&] { return solve(timed); });
    fmt::print("| {} | {:g} | {} | {:.2g} | {:.2g} | {:.0f} |\n", timed.name, timed.rtol, answer.unknowns,
               100 * answer.stated, seconds, mebibytes);
  }
}

/// The capacity of a body in units of 4πε₀ metres.
struct Capacity {
  std::size_t panels;
  double value;
  double stated;
};

/// Solves for the charge on the triangles of a sphere, as they are.
Capacity solve_sphere(int parts) {
  /// Accuracies that boundary elements use for an rtol of 1e-3.
  constexpr double quadrature_tolerance = 2e-5, iteration_accuracy = 5e-7;
  const detail::ChargedBodies bodies = detail::charged_bodies(isolated(Mesh{"", 1, geodesic_sphere(parts)}));
  detail::PanelSystem system(bodies, detail::PanelGrading{}, threads);
  system.refine({}, quadrature_tolerance);
  const detail::PanelSolution solution = system.solve(iteration_accuracy);
  return {system.mesh().panels().size(), solution.all.fine(0, 0), 0};
}

void measure_sizes() {
  fmt::print("\n| panels | s | times those of the row above | MiB | error, % |\n|---|---|---|---|---|\n");
  std::optional<double> before;
  // The number of panels is twenty times the square.
  for (const int parts : {35, 50, 71}) {
    const auto [answer, seconds, mebibytes] = in_own_process([&] { return solve_sphere(parts); });
    const double error = std::abs(answer.value - 1);
    fmt::print("| {} | {:.2g} | {} | {:.0f} | {:.2g} |\n", answer.panels, seconds,
               before ? fmt::format("{:.2f}", seconds / *before) : "", mebibytes, 100 * error);
    before = seconds;
  }
}

Capacity solve_body(const Shape& shape, double rtol) {
  const MaxwellMatrix matrix =
      maxwell(isolated(shape), {.rtol = rtol, .most_unknowns = most_unknowns_of_solids, .threads = threads});
  const double unit = 4 * std::numbers::pi * vacuum_permittivity;
  return {matrix.unknowns, matrix.values(0, 0) / unit, matrix.errors(0, 0) / unit};
}

void measure_solid(const std::string& name, const Shape& shape, double rtol,
                   std::optional<double> published) {
  const auto [answer, seconds, mebibytes] = in_own_process([&] { return solve_body(shape, rtol); });
  fmt::print("| {} | {:.7f} | {:.1e} | {} | {} | {:.2g} |\n", name, answer.value, answer.stated,
             published ? fmt::format("{:.8f}", *published) : "–", answer.panels, seconds);
}

void measure_solids() {
  fmt::print(
      "\n| edge 1 | C / 4πε₀ | stated error | published | unknowns | s |\n|---|---|---|---|---|---|\n");
  std::optional<double> of_cube;
  for (const Solid& solid : regular_polyhedra()) {
    measure_solid(solid.name, Mesh{"", 1, solid.triangles}, rtol_of_solids, solid.published);
    if (solid.name == "cube")
      of_cube = solid.published;
  }
  measure_solid("cube by functions on faces", Cuboid{1, 1, 1}, rtol_of_box, of_cube);
}

}  // namespace

int main() {
  measure_scenes();
  measure_sizes();
  measure_solids();
}
