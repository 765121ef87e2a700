#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include "fringe/batch_integral.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/surface_tree.hpp"
#include "scene/scene_evaluator.hpp"
#include "triangle_sets.hpp"

namespace fringe::benchmarks {

/// Runs the part whose instructions are counted: callgrind is given this function's name (--toggle-collect).
/// It is not inlined, and something remains to be done after the call, so that callgrind sees entry and exit.
[[gnu::noinline]] void counted_workload(const std::function<double()>& work, double& sum) {
  sum += work();
}

namespace {

/// A workload does the preparation that is not counted and returns the function that is.
using Workload = std::function<std::function<double()>()>;

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values)
    total += value;
  return total;
}

Workload integrals(const std::string& method, const TriangleSet& set) {
  return [=] {
    return [=] { return sum(plate_integrals(set.triangles, measured_plate(), parse_method(method))); };
  };
}

/// Returns the text of a scene of many small boxes, each on its own link.
std::string scene_of_boxes(int count) {
  std::string text = "[[sensor]]\nname = \"plate\"\n"
                     "plates = [ { corner = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]\n";
  for (int i = 0; i < count; ++i) {
    const int row = i / 10, column = i % 10;
    text += fmt::format("[[link]]\nname = \"link {0}\"\ntranslation = [{1}, {2}, 0.1]\n"
                        "rotation = {{ axis = [1, 2, 3], degrees = {0} }}\n"
                        "[[object]]\nname = \"box {0}\"\nlink = \"link {0}\"\n"
                        "shape = {{ type = \"cuboid\", size = [0.01, 0.02, 0.03] }}\n",
                        i, 0.04 * column - 0.15, 0.04 * row - 0.15);
  }
  return text;
}

/// A file that is removed on destruction.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() / fmt::format("instruction_counts.{}.toml", getpid())) {
    std::ofstream(path_) << text;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  TemporaryFile(TemporaryFile&&) = delete;
  TemporaryFile& operator=(TemporaryFile&&) = delete;
  ~TemporaryFile() {
    std::error_code left_behind;
    std::filesystem::remove(path_, left_behind);
  }

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::function<double()> loading_of_a_scene() {
  const auto file = std::make_shared<TemporaryFile>(scene_of_boxes(100));
  return [file] { return static_cast<double>(load_scene(file->path()).objects.size()); };
}

std::function<double()> capacitance_of_a_scene() {
  const Scene scene = load_scene(TemporaryFile(scene_of_boxes(100)).path());
  return [scene] { return capacitance(scene).sensors.front().total; };
}

Workload batched(double tolerance, const TriangleSet& set) {
  return [=]() -> std::function<double()> {
    return [=, batch = TriangleBatch(set.triangles)] {
      return total_integrals(batch, std::vector{measured_plate()}, tolerance, 1).front().value;
    };
  };
}

Workload making_a_tree(const TriangleSet& set) {
  return [=] { return [=] { return static_cast<double>(SurfaceTree(set.triangles).triangle_count()); }; };
}

Workload by_tree(double tolerance, const TriangleSet& set) {
  return [=]() -> std::function<double()> {
    const auto tree = std::make_shared<SurfaceTree>(set.triangles);
    return [=] { return tree->integrate(measured_plate(), tolerance).value; };
  };
}

/// Moves one of many links, after the trees are built.
std::function<double()> pose_of_a_scene() {
  const Scene scene = load_scene(TemporaryFile(scene_of_boxes(100)).path());
  const auto evaluator = std::make_shared<SceneEvaluator>(scene, EvaluationOptions{.tolerance = 1e-4});
  evaluator->capacitance();
  evaluator->capacitance();
  return [evaluator, step = 0]() mutable {
    evaluator->set_pose("link 7", pose_from_axis({1, 2, 3}, 10.0 * ++step, {0.1, 0.1, 0.1}));
    return evaluator->capacitance().sensors.front().total;
  };
}

std::map<std::string, Workload> workloads() {
  constexpr std::size_t count = 1000;
  std::vector<TriangleSet> sets{small_straddlers(count), nine_cell_straddlers(count), closed_mesh(40)};
  for (const Region region : {Region::face, Region::edge, Region::corner}) {
    sets.push_back(fine_triangles(region, count));
    sets.push_back(coarse_triangles(region, count));
  }
  std::map<std::string, Workload> all;
  for (const TriangleSet& set : sets)
    all[set.name + "/exact"] = integrals("exact", set);
  all["closed_mesh/split:4"] = integrals("split:4", closed_mesh(40));
  all["closed_mesh/gauss:4"] = integrals("gauss:4", closed_mesh(40));
  all["closed_mesh/batch"] = batched(0, closed_mesh(40));
  all["closed_mesh/tolerance:1e-6"] = batched(1e-6, closed_mesh(40));
  all["closed_mesh/tree"] = making_a_tree(closed_mesh(40));
  all["closed_mesh/tree:1e-6"] = by_tree(1e-6, closed_mesh(100));
  all["scene/pose"] = pose_of_a_scene;
  all["scene/load"] = loading_of_a_scene;
  all["scene/capacitance"] = capacitance_of_a_scene;
  return all;
}

/// Does the work twice and counts the second time, so that data computed once and kept, such as tables of
/// nodes, are not counted.
void count(const Workload& workload) {
  // One thread only, since callgrind does not count the others.
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::function<double()> work = workload();
  double results = work();
  counted_workload(work, results);
  fmt::print("{:.17g}\n", results);
}

int run(const std::string& name) {
  const std::map<std::string, Workload> known = workloads();
  if (name == "--list") {
    for (const auto& [workload, unused] : known)
      fmt::print("{}\n", workload);
    return 0;
  }
  const auto found = known.find(name);
  if (found == known.end()) {
    fmt::print(stderr, "instruction_counts: no workload is named '{}'; --list names them\n", name);
    return 2;
  }
  count(found->second);
  return 0;
}

}  // namespace
}  // namespace fringe::benchmarks

/// Runs one workload (`instruction_counts WORKLOAD`), whose instructions tests/model/instruction_counts.py
/// counts; `instruction_counts --list` prints the names of the workloads.
int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    fmt::print(stderr, "usage: instruction_counts WORKLOAD | --list\n");
    return 2;
  }
  try {
    return fringe::benchmarks::run(arguments[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "instruction_counts: {}\n", error.what());
    return 1;
  }
}
