#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include "accurate_integral.hpp"
#include "fringe/batch_integral.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/surface_tree.hpp"
#include "triangle_sets.hpp"

/// Measures run time and error of every method on the sets of triangles that determine the speed of a scene,
/// as SET/METHOD. Counters: `per_triangle` in seconds; `error`, the largest relative error; `triangles`, the
/// number evaluated, which is a sample of the set for slow methods.
namespace {

using namespace fringe;
using namespace fringe::benchmarks;

using Values = std::vector<double>;
using Evaluation = std::function<Values()>;

/// A method to measure. `prepare` does the work that is not timed and returns the work that is: it computes
/// the integrals of the triangles, in their order.
struct MeasuredMethod {
  std::string name;
  std::size_t most_triangles;
  std::function<Evaluation(const std::vector<Triangle>&)> prepare;
};

constexpr std::size_t all = static_cast<std::size_t>(-1);

MeasuredMethod one_by_one(const std::string& name, std::size_t most_triangles) {
  const auto prepare = [method = parse_method(name)](const std::vector<Triangle>& triangles) -> Evaluation {
    return [=, &triangles] { return plate_integrals(triangles, measured_plate(), method); };
  };
  return {name, most_triangles, prepare};
}

/// Lays out the triangles in advance, as for a surface that is evaluated against many plates.
MeasuredMethod prepared(const std::string& name, double tolerance) {
  const auto prepare = [=](const std::vector<Triangle>& triangles) -> Evaluation {
    return [=, batch = TriangleBatch(triangles)] {
      return plate_integrals(batch, measured_plate(), tolerance, 1);
    };
  };
  return {name, all, prepare};
}

/// Computes the integrals, and the derivatives of their sum with respect to a pose.
MeasuredMethod prepared_with_derivatives() {
  const auto prepare = [](const std::vector<Triangle>& triangles) -> Evaluation {
    return [batch = TriangleBatch(triangles)] {
      benchmark::DoNotOptimize(total_derivatives(batch, measured_plate()));
      return plate_integrals(batch, measured_plate(), 0, 1);
    };
  };
  return {"batch+derivatives", all, prepare};
}

/// Computes only the sum over the triangles, by a tree built in advance.
MeasuredMethod summed_by_tree(const std::string& name, double tolerance) {
  const auto prepare = [=](const std::vector<Triangle>& triangles) -> Evaluation {
    return [=, tree = std::make_shared<SurfaceTree>(triangles)] {
      return Values{tree->integrate(measured_plate(), tolerance).value};
    };
  };
  return {name, all, prepare};
}

std::vector<MeasuredMethod> measured_methods() {
  // With this many triangles one evaluation takes about 10 ms; a node takes about 3 ns.
  const auto affordable = [](std::size_t nodes) { return 4'000'000 / nodes; };
  std::vector<MeasuredMethod> methods{one_by_one("exact", all)};
  for (std::size_t levels = 0, nodes = 1; levels <= 8; ++levels, nodes *= 4)
    methods.push_back(one_by_one(fmt::format("split:{}", levels), affordable(nodes)));
  for (const std::size_t points : {1, 2, 4, 8, 16})
    methods.push_back(one_by_one(fmt::format("gauss:{}", points), affordable(points * points)));
  methods.push_back(prepared("batch", 0));
  methods.push_back(prepared_with_derivatives());
  for (const char* tolerance : {"1e-12", "1e-9", "1e-6", "1e-3"})
    methods.push_back(prepared(fmt::format("tolerance:{}", tolerance), std::stod(tolerance)));
  for (const char* tolerance : {"1e-9", "1e-6", "1e-4", "1e-3"})
    methods.push_back(summed_by_tree(fmt::format("tree:{}", tolerance), std::stod(tolerance)));
  return methods;
}

/// The true integrals of a set's triangles.
using Truth = std::vector<long double>;

struct MeasuredSet {
  TriangleSet set;
  Truth truth;
};

MeasuredSet with_truth(const TriangleSet& set) {
  Truth truth;
  for (const Triangle& triangle : set.triangles)
    truth.push_back(accurate_integral(triangle, measured_plate()));
  return {set, truth};
}

std::vector<MeasuredSet> measured_sets() {
  constexpr std::size_t count = 2000;
  std::vector<MeasuredSet> sets;
  for (const Region region : {Region::face, Region::edge, Region::corner})
    sets.push_back(with_truth(fine_triangles(region, count)));
  for (const Region region : {Region::face, Region::edge, Region::corner})
    sets.push_back(with_truth(coarse_triangles(region, count)));
  sets.push_back(with_truth(small_straddlers(count)));
  sets.push_back(with_truth(nine_cell_straddlers(count)));
  sets.push_back(with_truth(closed_mesh(318)));
  return sets;
}

/// Selects at most `most` elements, evenly spread.
template <class Element>
std::vector<Element> sample(const std::vector<Element>& elements, std::size_t most) {
  if (elements.size() <= most)
    return elements;
  std::vector<Element> chosen;
  for (std::size_t i = 0; i < most; ++i)
    chosen.push_back(elements[i * elements.size() / most]);
  return chosen;
}

/// Returns the largest relative error of the values, or that of their sum if the method computes only the
/// sum.
double largest_relative_error(const Values& values, const Truth& truth) {
  if (values.size() == 1) {
    const long double sum = std::accumulate(truth.begin(), truth.end(), 0.0L);
    return static_cast<double>(std::abs((values[0] - sum) / sum));
  }
  long double largest = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    largest = std::max(largest, std::abs((values[i] - truth[i]) / truth[i]));
  return static_cast<double>(largest);
}

void run(benchmark::State& state, const MeasuredSet& measured, const MeasuredMethod& method) {
  const std::vector<Triangle> triangles = sample(measured.set.triangles, method.most_triangles);
  const Evaluation evaluate = method.prepare(triangles);
  Values values;
  for ([[maybe_unused]] auto step : state)
    benchmark::DoNotOptimize(values = evaluate());
  const auto count = static_cast<double>(triangles.size());
  state.counters["per_triangle"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["error"] = largest_relative_error(values, sample(measured.truth, method.most_triangles));
  state.counters["triangles"] = count;
}

}  // namespace

int main(int argument_count, char** arguments) {
  // A tenth of the usual time per measurement keeps the total within a minute. An option given on the command
  // line takes precedence, since the last one counts.
  std::string minimum_time = "--benchmark_min_time=0.05";
  std::vector<char*> given(arguments, arguments + argument_count);
  given.insert(given.begin() + 1, minimum_time.data());
  argument_count = static_cast<int>(given.size());
  benchmark::Initialize(&argument_count, given.data());
  if (benchmark::ReportUnrecognizedArguments(argument_count, given.data()))
    return 2;
  benchmark::AddCustomContext("compiler", FRINGE_COMPILER);

  // Methods are compared on one core; the benchmark's clock measures this thread only.
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<MeasuredSet> sets = measured_sets();
  const std::vector<MeasuredMethod> methods = measured_methods();
  for (const MeasuredSet& measured : sets)
    for (const MeasuredMethod& method : methods)
      benchmark::RegisterBenchmark(fmt::format("{}/{}", measured.set.name, method.name).c_str(),
                                   [&](benchmark::State& state) { run(state, measured, method); })
          ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
}
