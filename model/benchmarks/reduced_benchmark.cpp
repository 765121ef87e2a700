/// Measures the reduced method by the accuracy asked for: error, time per pose, and whether the stated error
/// covers the true one, over random poses of plates, of boxes and of bodies of triangles, and over the scene
/// files given. The true values are those of boundary elements at rtol = 1e-4 (less strict for triangles); a
/// set-up for which that is not reached is omitted. Methods take turns; times are processor times of this
/// thread, the least of five moves to the same pose. Options choose other subjects (--help).

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cover_rows.hpp"
#include "fringe/error.hpp"
#include "fringe/scene_reader.hpp"
#include "machine_rows.hpp"
#include "mesh_poses.hpp"
#include "processor_time.hpp"
#include "random.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scene/scene_evaluator.hpp"

namespace {

using namespace fringe;
using namespace fringe::benchmarks;
using Eigen::Vector3d;

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
  double number(double from, double to) { return random_.uniform(from, to); }

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
  Random random_;
};

/// The result of one method for one set-up.
struct Measurement {
  double error;
  double microseconds;
  bool reached;
  bool covered;
};

/// The accuracies that are asked for.
constexpr std::array accuracies{1e-2, 1e-3, 3e-4};

struct Measurements {
  std::vector<std::vector<Measurement>> by_accuracy{accuracies.size()};
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
  const double microseconds = 1e6 * least_seconds_of([&] {
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
  measured.triangle_integral.push_back(1e6 * least_seconds_of([&] {
                                         evaluator.set_pose(link, pose);
                                         evaluator.capacitance();
                                       }));
}

/// Measures one body, prepared once, in many poses.
void measure_body(const MeshBody& body, int count, Measurements& measured) {
  Scene known = mesh_scene(body.known);
  const Scene scene = mesh_scene(body.shape);
  std::vector<ReducedEvaluator> evaluators;
  for (const double rtol : accuracies)
    evaluators.emplace_back(scene, ReducedOptions{.rtol = rtol});
  for (const Eigen::Isometry3d& pose : mesh_poses(body.shape, count, 1)) {
    known.links[0].pose = pose;
    const MaxwellMatrix truth = maxwell(known, {.rtol = body.known_to});
    if (!truth.reached) {
      ++measured.unknown;
      continue;
    }
    for (std::size_t k = 0; k < evaluators.size(); ++k)
      measured.by_accuracy[k].push_back(measured_answer(evaluators[k], "body", pose, truth));
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
  for (std::size_t k = 0; k < accuracies.size(); ++k) {
    ReducedEvaluator evaluator(scene, {.rtol = accuracies[k]});
    measured.by_accuracy[k].push_back(measured_answer(evaluator, mover, here, truth));
  }
  measure_integral(scene, mover, here, measured);
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
  for (std::size_t k = 0; k < accuracies.size(); ++k) {
    std::vector<double> errors, reached_errors, times;
    std::size_t covered = 0;
    for (const Measurement& one : measured.by_accuracy[k]) {
      errors.push_back(100 * one.error);
      times.push_back(one.microseconds);
      covered += one.covered;
      if (one.reached)
        reached_errors.push_back(100 * one.error);
    }
    fmt::print(
        "  reduced, rtol {:g}: error % median {:.4f}, worst {:.4f}; reached {}, worst {:.4f}; covered {}; "
        "µs mean {:.1f}, median {:.1f}, longest {:.0f}\n",
        accuracies[k], quantile(errors, 0.5), quantile(errors, 1), reached_errors.size(),
        reached_errors.empty() ? 0 : quantile(reached_errors, 1), covered, mean(times), quantile(times, 0.5),
        quantile(times, 1));
  }
}

void measure_meshes(int count) {
  for (const MeshBody& body : mesh_bodies()) {
    Measurements measured;
    measure_body(body, count, measured);
    summarise(body.name + ", random poses", measured);
  }
}

/// The options and scene files of the command line.
struct Request {
  std::vector<std::string> files;
  std::optional<int> meshes;
  std::optional<std::size_t> machine, covers;
  std::vector<std::string> moving;  ///< scene, number of poses and, if there are three, folder
};

void run(const Request& request) {
  constexpr int mesh_count = 40;
  if (request.meshes)
    return measure_meshes(*request.meshes);
  if (request.machine)
    return measure_hand_before_arm(*request.machine);
  if (request.covers)
    return measure_covers(*request.covers);
  if (!request.moving.empty())
    return measure_motion(request.moving[0], std::stoul(request.moving[1]),
                          request.moving.size() > 2 ? std::optional(request.moving[2]) : std::nullopt);
  Measurements of_files;
  for (const std::string& file : request.files)
    measure(load_scene(file), of_files);
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

}  // namespace

int main(int argument_count, char** arguments) {
  CLI::App program("Measures the reduced method: run time against error.");
  Request request;
  program.add_option("SCENE", request.files, "Scene files that are measured, too");
  program.add_option("--meshes", request.meshes, "Only bodies of triangles, in so many poses");
  program.add_option("--machine", request.machine,
                     "Only readings of a hand before an arm; so many poses are compared");
  program.add_option("--covers", request.covers, "Only sensors under covers, in so many poses");
  program
      .add_option("--moving", request.moving,
                  "Only readings of a scene in so many frames of the motion beside it, and with prepared "
                  "data in a folder")
      ->expected(2, 3);
  CLI11_PARSE(program, argument_count, arguments);
  try {
    run(request);
  } catch (const std::exception& error) {
    fmt::print(stderr, "reduced_benchmark: {}\n", error.what());
    return 2;
  }
  return 0;
}
