#include "machine_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <fmt/format.h>

#include "fringe/live_scene.hpp"
#include "fringe/motion.hpp"
#include "fringe/scene_reader.hpp"
#include "hand_before_arm.hpp"
#include "processor_time.hpp"

namespace fringe::benchmarks {

void measure_hand_before_arm(std::size_t compared) {
  constexpr std::size_t poses = 500;
  constexpr double truth_rtol = 1e-2;
  const Scene scene = hand_before_arm();
  const std::vector<Frame> motion = hand_poses(scene, poses);
  for (const double rtol : {1e-1, 5e-2, 1e-2}) {
    LiveScene live(scene);
    const EvaluationOptions options{.method = Reduced{}, .rtol = rtol};
    std::vector<std::vector<ReadingAnswer>> answers;
    const double first = seconds_of([&] { live.readings_of(motion, options, 1); });
    const double again = seconds_of([&] { answers = live.readings_of(motion, options, 1); });
    fmt::print("hand of {} triangles before an arm of {} with {} sensors, rtol {}: {} poses, {:.2f} ms each, "
               "{:.1f} s to prepare\n",
               triangles_of(scene, true), triangles_of(scene, false), scene.sensors.size(), rtol, poses,
               1e3 * again / poses, first - again);
    std::fflush(stdout);
    std::vector<double> errors;
    double squares = 0, stated = 0, ratio = 0;
    std::size_t covered = 0;
    for (std::size_t k = 0; k < compared; ++k) {
      const std::size_t pose = (k + 1) * poses / compared - 1;
      LiveScene there(scene);
      there.set_poses(motion[pose].poses);
      const Evaluation truth = there.evaluate({.method = BoundaryElements{}, .rtol = truth_rtol});
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

void measure_motion(const std::filesystem::path& file, std::size_t poses,
                    const std::optional<std::string>& folder) {
  constexpr double rtol = 1e-2;
  const Scene scene = load_scene(file);
  std::vector<Frame> motion =
      load_motion(std::filesystem::path(file).replace_extension(".motion.toml"), scene);
  motion.resize(std::min(poses, motion.size()));
  EvaluationOptions options{.method = Reduced{}, .rtol = rtol};
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

}  // namespace fringe::benchmarks
