/// Measures the reduced method by its steps: error, time per pose, and whether the stated error covers the
/// true one, over random poses of plates, of boxes and of bodies of triangles, and over the scene files
/// given; with --meshes COUNT only over this many poses of the bodies of triangles. The true values are those
/// of boundary elements at rtol = 1e-4 (less strict for triangles); a set-up for which that is not reached is
/// omitted; with --machine COUNT only the formula in company, for a hand in 500 poses before an arm, compared
/// in COUNT of them with boundary elements; with --moving SCENE POSES only that formula on the first so many
/// frames of SCENE.motion.toml, beside the scene, and with the folder of prepared data named behind these
/// also from that (python3 -m analysis.topics.machines.moving --write FOLDER writes such scenes). Methods
/// take turns; times are processor times of this thread, the least of five moves to the same pose.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/motion.hpp"
#include "fringe/reduced_capacitance.hpp"
#include "fringe/scene_evaluator.hpp"
#include "fringe/scene_reader.hpp"
#include "hand_before_arm.hpp"
#include "mesh_poses.hpp"

namespace {

using namespace fringe;
using Eigen::Vector3d;

constexpr int repeats = 5;  ///< moves per measurement; the quickest counts

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Name of an additional link that carries the objects, so that they can be moved.
constexpr const char* mover = "objects of the benchmark";

Scene movable(Scene scene) {
  scene.links.push_back({mover, {}, Eigen::Isometry3d::Identity()});
  for (Object& object : scene.objects)
    if (!object.link)
      object.link = scene.links.size() - 1;
  return scene;
}

/// Makes scenes of a sensor of 10 cm and a plate or box of 2 to 20 cm, at least 5 mm apart.
class RandomScenes {
 public:
  explicit RandomScenes(bool boxes) : boxes_(boxes) {}

  Scene next() {
    while (true) {
      Scene scene;
      scene.sensors.push_back({"sensor", {}, 2.5, 5e-12, {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}}});
      const auto size = [this] { return 0.02 * std::pow(10, number(0, 1)); };
      const Cuboid sizes{size(), size(), boxes_ ? size() : 0};
      Eigen::Isometry3d pose(
          Eigen::Translation3d(number(-0.15, 0.15), number(-0.15, 0.15), number(0.005, 0.155)));
      if (number(0, 1) < 2.0 / 3)
        pose.rotate(Eigen::AngleAxisd(number(0, 6.2),
                                      Vector3d(number(-1, 1), number(-1, 1), number(-1, 1)).normalized()));
      if (distance(sizes, pose) < 0.005)
        continue;
      const Shape shape = boxes_ ? Shape(sizes) : Shape(Plate{sizes.size_x, sizes.size_y});
      scene.objects.push_back({"target", {}, shape, pose, Grounded{}, true});
      return scene;
    }
  }

 private:
  double number(double from, double to) {
    return from + (to - from) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }

  /// Estimates the distance over a grid of points of each body in turn, to a few millimetres.
  static double distance(const Cuboid& sizes, const Eigen::Isometry3d& pose) {
    const Vector3d half = Vector3d(sizes.size_x, sizes.size_y, sizes.size_z) / 2, sensor(0.05, 0.05, 0);
    const auto beside = [](const Vector3d& point, const Vector3d& box) {
      return (point.cwiseAbs() - box).cwiseMax(0).norm();
    };
    const Eigen::Isometry3d back = pose.inverse();
    double least = 1;
    for (double x = -1; x <= 1; x += 0.1)
      for (double y = -1; y <= 1; y += 0.1) {
        for (double z = -1; z <= 1; z += 0.1)
          least = std::min(least, beside(pose * half.cwiseProduct(Vector3d(x, y, z)), sensor));
        least = std::min(least, beside(back * Vector3d(0.05 * x, 0.05 * y, 0), half));
      }
    return least;
  }

  bool boxes_;
  std::mt19937_64 random_{1};
};

/// The result of one method for one set-up.
struct Measurement {
  double error;
  double microseconds;
  bool reached;
  bool covered;
};

double quickest(const std::function<void()>& answer) {
  double least = 1e9;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double start = processor_seconds();
    answer();
    least = std::min(least, processor_seconds() - start);
  }
  return 1e6 * least;
}

struct Measurements {
  std::vector<std::vector<Measurement>> by_steps{most_reduced_steps};
  std::vector<double> triangle_integral;  ///< times in µs
  std::size_t unknown = 0;
};

/// Moves a link and compares the answer with the truth.
Measurement measured_answer(ReducedEvaluator& evaluator, const std::string& link,
                            const Eigen::Isometry3d& pose, const MaxwellMatrix& truth) {
  evaluator.set_pose(link, pose);
  const MaxwellMatrix answer = evaluator.maxwell();
  const Eigen::ArrayXXd difference = (answer.values - truth.values).array().abs();
  const Eigen::ArrayXd delta = (answer.delta_self - truth.delta_self).array().abs();
  const double microseconds = quickest([&] {
    evaluator.set_pose(link, pose);
    evaluator.maxwell();
  });
  return {(difference / truth.values.array().abs()).maxCoeff(), microseconds, answer.reached,
          (difference <= answer.errors.array() + truth.errors.array()).all() &&
              (delta <= answer.delta_self_errors.array() + truth.delta_self_errors.array()).all()};
}

void measure_integral(const Scene& scene, const std::string& link, const Eigen::Isometry3d& pose,
                      Measurements& measured) {
  SceneEvaluator evaluator(scene);
  measured.triangle_integral.push_back(quickest([&] {
    evaluator.set_pose(link, pose);
    evaluator.capacitance();
  }));
}

/// Measures one body, prepared once, in many poses.
void measure_body(const benchmarks::MeshBody& body, int count, Measurements& measured) {
  Scene known = benchmarks::mesh_scene(body.known);
  const Scene scene = benchmarks::mesh_scene(body.shape);
  std::vector<ReducedEvaluator> evaluators;
  for (int steps = 1; steps <= most_reduced_steps; ++steps)
    evaluators.emplace_back(scene, ReducedOptions{.steps = steps, .rtol = {}});
  for (const Eigen::Isometry3d& pose : benchmarks::mesh_poses(body.shape, count, 1)) {
    known.links[0].pose = pose;
    const MaxwellMatrix truth = maxwell(known, {.rtol = body.known_to});
    if (!truth.reached) {
      ++measured.unknown;
      continue;
    }
    for (std::size_t k = 0; k < evaluators.size(); ++k)
      measured.by_steps[k].push_back(measured_answer(evaluators[k], "body", pose, truth));
    measure_integral(scene, "body", pose, measured);
  }
}

void measure(const Scene& from, Measurements& measured) {
  const Scene scene = movable(from);
  MaxwellMatrix truth;
  try {
    truth = maxwell(scene, {.rtol = 1e-4});
  } catch (const InputError&) {
    return;
  }
  if (!truth.reached) {
    ++measured.unknown;
    return;
  }
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  for (int steps = 1; steps <= most_reduced_steps; ++steps) {
    ReducedEvaluator evaluator(scene, {.steps = steps, .rtol = {}});
    measured.by_steps[static_cast<std::size_t>(steps - 1)].push_back(
        measured_answer(evaluator, mover, here, truth));
  }
  measure_integral(scene, mover, here, measured);
}

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values)
    sum += value;
  return sum / static_cast<double>(values.size());
}

void summarise(const std::string& what, const Measurements& measured) {
  if (measured.triangle_integral.empty())
    return;
  fmt::print("{}: {} set-ups, {} more whose truth was not found; the triangle integral takes {:.1f} µs in "
             "the mean\n",
             what, measured.triangle_integral.size(), measured.unknown, mean(measured.triangle_integral));
  for (int steps = 1; steps <= most_reduced_steps; ++steps) {
    std::vector<double> errors, reached_errors, times;
    std::size_t covered = 0;
    for (const Measurement& one : measured.by_steps[static_cast<std::size_t>(steps - 1)]) {
      errors.push_back(100 * one.error);
      times.push_back(one.microseconds);
      covered += one.covered;
      if (one.reached)
        reached_errors.push_back(100 * one.error);
    }
    fmt::print("  reduced:{} error % median {:.4f}, worst {:.4f}; reached {}, worst {:.4f}; covered {}; "
               "µs mean {:.1f}, median {:.1f}, longest {:.0f}\n",
               steps, quantile(errors, 0.5), quantile(errors, 1), reached_errors.size(),
               reached_errors.empty() ? 0 : quantile(reached_errors, 1), covered, mean(times),
               quantile(times, 0.5), quantile(times, 1));
  }
}

void measure_meshes(int count) {
  for (const benchmarks::MeshBody& body : benchmarks::mesh_bodies()) {
    Measurements measured;
    measure_body(body, count, measured);
    summarise(body.name + ", random poses", measured);
  }
}

/// Measures the readings of a motion by the formula in company at an accuracy asked for.
void measure_machine(std::size_t compared) {
  constexpr std::size_t poses = 500;
  constexpr double truth_rtol = 1e-2;
  const Scene scene = benchmarks::hand_before_arm();
  const std::vector<Frame> motion = benchmarks::hand_poses(scene, poses);
  for (const double rtol : {2e-2, 1e-2}) {
    LiveScene live(scene);
    const EvaluationOptions options{.correction = Correction::formula, .rtol = rtol};
    double start = processor_seconds();
    live.readings_of(motion, options, 1);
    const double first = processor_seconds() - start;
    start = processor_seconds();
    const std::vector<std::vector<ReadingAnswer>> answers = live.readings_of(motion, options, 1);
    const double again = processor_seconds() - start;
    fmt::print("hand of {} triangles before an arm of {} with {} sensors, rtol {}: {} poses, {:.2f} ms each, "
               "{:.1f} s to prepare\n",
               benchmarks::triangles_of(scene, true), benchmarks::triangles_of(scene, false),
               scene.sensors.size(), rtol, poses, 1e3 * again / poses, first - again);
    std::fflush(stdout);
    std::vector<double> errors;
    double squares = 0, stated = 0, ratio = 0;
    std::size_t covered = 0;
    for (std::size_t k = 0; k < compared; ++k) {
      const std::size_t pose = (k + 1) * poses / compared - 1;
      LiveScene there(scene);
      there.set_poses(motion[pose].poses);
      const Evaluation truth =
          there.evaluate({.method = BoundaryElements{}, .rtol = truth_rtol, .entries = Entries::of_readings});
      for (std::size_t reading = 0; reading < truth.readings.size(); ++reading) {
        const Estimate &known = truth.readings[reading].change, &found = answers[pose][reading].change;
        const double error = std::abs(*found.value - *known.value);
        errors.push_back(100 * error / std::abs(*known.value));
        squares += errors.back() * errors.back();
        stated += 100 * *found.error / std::abs(*known.value);
        covered += error <= *found.error + *known.error;
        ratio = std::max(ratio, error / *found.error);
      }
    }
    if (!errors.empty())
      fmt::print("  {} changes: rms {:.2f} %, median {:.2f} %, worst {:.2f} %; stated in the mean {:.2f} %; "
                 "covered {}, largest difference per stated error {:.2f}\n",
                 errors.size(), std::sqrt(squares / static_cast<double>(errors.size())),
                 quantile(errors, 0.5), quantile(errors, 1), stated / static_cast<double>(errors.size()),
                 covered, ratio);
  }
}

double seconds_of(const std::function<void()>& action) {
  const double start = processor_seconds();
  action();
  return processor_seconds() - start;
}

/// Measures the readings of a scene and its motion by the formula in company, first without and then with
/// prepared data that are kept in a folder, if one is named.
void measure_motion(const std::filesystem::path& file, std::size_t poses,
                    const std::optional<std::string>& folder) {
  constexpr double rtol = 1e-2;
  const Scene scene = load_scene(file);
  std::vector<Frame> motion =
      load_motion(std::filesystem::path(file).replace_extension(".motion.toml"), scene);
  motion.resize(std::min(poses, motion.size()));
  EvaluationOptions options{.correction = Correction::formula, .rtol = rtol};
  const auto report = [&](const std::string& how) {
    LiveScene live(scene);
    std::vector<std::vector<ReadingAnswer>> answers;
    const double first = seconds_of([&] { live.readings_of(motion, options, 1); });
    const double again = seconds_of([&] { answers = live.readings_of(motion, options, 1); });
    std::vector<double> stated;
    for (const std::vector<ReadingAnswer>& pose : answers)
      for (const ReadingAnswer& reading : pose)
        if (reading.change.value && reading.change.error && std::isfinite(*reading.change.value))
          stated.push_back(100 * *reading.change.error / std::abs(*reading.change.value));
    fmt::print(
        "{}, {} links with {} sensors, rtol {}{}: {} poses, {:.1f} ms each, {:.1f} s to prepare; stated "
        "in the median {:.1f} %\n",
        file.stem().string(), scene.links.size(), scene.sensors.size(), rtol, how, motion.size(),
        1e3 * again / static_cast<double>(motion.size()), first - again, quantile(stated, 0.5));
    std::fflush(stdout);
  };
  report("");
  if (!folder)
    return;
  options.prepared = *folder;
  report(", prepared data written");
  report(", prepared data read");
}

}  // namespace

int main(int argument_count, char** arguments) {
  constexpr int mesh_count = 40;
  if (argument_count == 3 && std::string(arguments[1]) == "--meshes") {
    measure_meshes(std::stoi(arguments[2]));
    return 0;
  }
  if (argument_count == 3 && std::string(arguments[1]) == "--machine") {
    measure_machine(std::stoul(arguments[2]));
    return 0;
  }
  if (argument_count >= 4 && argument_count <= 5 && std::string(arguments[1]) == "--moving") {
    measure_motion(arguments[2], std::stoul(arguments[3]),
                   argument_count > 4 ? std::optional<std::string>(arguments[4]) : std::nullopt);
    return 0;
  }
  Measurements of_files;
  for (int k = 1; k < argument_count; ++k)
    measure(load_scene(arguments[k]), of_files);
  summarise("scene files", of_files);
  for (const auto& [what, boxes, count] :
       {std::tuple("plates, random poses", false, 500), std::tuple("boxes, random poses", true, 100)}) {
    RandomScenes scenes(boxes);
    Measurements measured;
    for (int k = 0; k < count; ++k)
      measure(scenes.next(), measured);
    summarise(what, measured);
  }
  measure_meshes(mesh_count);
}
