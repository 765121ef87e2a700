#include "sweep.hpp"

#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "csv_text.hpp"
#include "fringe/error.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/motion.hpp"
#include "fringe/reading.hpp"
#include "fringe/remarks.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/version.hpp"
#include "program.hpp"
#include "units.hpp"
#include "whole_files.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* header =
    "frame,name,reading,answered_by,value_F,value_error_F,background_F,background_error_F,change_F,"
    "change_error_F,delta_voltage_V,threshold_F,noticed\n";

/// Tells whether a change is noticed.
enum class Noticed { no, yes, unsure, not_known };

std::string to_string(Noticed noticed) {
  switch (noticed) {
  case Noticed::no:
    return "no";
  case Noticed::yes:
    return "yes";
  case Noticed::unsure:
    return "unsure";
  default:
    return "";
  }
}

/// Compares the size of a change with a threshold; `unsure` if the error decides.
Noticed noticed(const Estimate& change, const std::optional<double>& threshold) {
  if (!threshold || !change.value)
    return Noticed::not_known;
  const double error = change.error.value_or(0), size = std::abs(*change.value);
  if (size - error > *threshold)
    return Noticed::yes;
  return size + error > *threshold ? Noticed::unsure : Noticed::no;
}

/// Returns by how much the targets lower the output of the divider, if the reading is that of a sensor alone.
std::optional<double> delta_voltage(const Scene& scene, const Reading& reading, const ReadingAnswer& answer) {
  if (!answer.value.value || !answer.background.value || reading.drive != std::vector{reading.sense})
    return std::nullopt;
  for (const Sensor& sensor : scene.sensors)
    if (sensor.name == reading.sense)
      return divider_voltage(sensor, *answer.background.value) - divider_voltage(sensor, *answer.value.value);
  return std::nullopt;
}

std::string text_of(const std::optional<double>& number) {
  return number ? fmt::format("{}", *number) : std::string();
}

/// The table of the frames evaluated so far, and which of their changes are noticed.
struct Sweep {
  std::string table = header;
  std::vector<std::vector<Noticed>> noticed;  ///< for every frame and reading
  bool reached = true;
};

/// Adds the rows of a frame.
void add_frame(const Scene& scene, std::size_t number, const std::string& name, const Evaluation& answer,
               Sweep& sweep) {
  const std::vector<Reading> described = readings(scene);
  std::vector<Noticed>& of_frame = sweep.noticed.emplace_back();
  for (std::size_t k = 0; k < described.size(); ++k) {
    const ReadingAnswer& reading = answer.readings[k];
    of_frame.push_back(noticed(reading.change, described[k].threshold));
    sweep.table += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{}\n", number, csv_field(name), csv_field(reading.name),
        reading.answered_by, text_of(reading.value.value), text_of(reading.value.error),
        text_of(reading.background.value), text_of(reading.background.error), text_of(reading.change.value),
        text_of(reading.change.error), text_of(delta_voltage(scene, described[k], reading)),
        text_of(described[k].threshold), to_string(of_frame.back()));
  }
  sweep.reached = sweep.reached && answer.reached;
}

/// Returns a line for every reading with a threshold: in which frames it is noticed.
std::string summary(const Scene& scene, const std::vector<Frame>& motion, const Sweep& sweep) {
  std::string text;
  const std::vector<Reading> described = readings(scene);
  for (std::size_t k = 0; k < described.size(); ++k) {
    if (!described[k].threshold)
      continue;
    text += fmt::format("{}, threshold {:.6g} fF:", described[k].name,
                        *described[k].threshold * femtofarads_per_farad);
    std::string before;
    for (std::size_t frame = 0; frame < motion.size(); ++frame) {
      const Noticed now = sweep.noticed[frame][k];
      const std::string words = now == Noticed::yes      ? "noticed"
                                : now == Noticed::no     ? "not noticed"
                                : now == Noticed::unsure ? "not sure"
                                                         : "not known";
      if (words != before)
        text += fmt::format("{} {} from frame {} ({})", before.empty() ? "" : ",", words, frame + 1,
                            motion[frame].name);
      before = words;
    }
    text += "\n";
  }
  return text;
}

}  // namespace

fs::path motion_file(const fs::path& scene, const std::optional<std::string>& named) {
  return named ? fs::path(*named) : fs::path(scene).replace_extension(".motion.toml");
}

CLI::App* add_sweep_command(CLI::App& program, SweepRequest& request) {
  CLI::App* command = program.add_subcommand(
      "sweep", "The readings of a scene in every frame of a motion, as CSV, and where they are noticed");
  command->set_version_flag("--version", version());
  command->add_option("SCENE", request.scene, "The scene file (TOML)")->required();
  command->add_option("--motion", request.motion, "The motion file (if not given, SCENE.motion.toml)")
      ->type_name("FILE");
  add_method_options(*command, request.method);
  command
      ->add_option("--output", request.output,
                   "Write the CSV to this file, after every frame, and print a summary. Missing folders are "
                   "made")
      ->type_name("FILE.csv");
  return command;
}

int run_sweep(const SweepRequest& request) {
  const EvaluationOptions options = options_of(request.method);
  LiveScene live(load_scene(request.scene));
  const std::vector<Frame> motion = load_motion(motion_file(request.scene, request.motion), live.scene());
  std::optional<MissingFolders> folders;
  if (request.output)
    folders.emplace(fs::absolute(*request.output).parent_path());
  Sweep sweep;
  for (std::size_t frame = 0; frame < motion.size(); ++frame) {
    if (isatty(STDERR_FILENO) != 0)
      fmt::print(stderr, "\rfringe: frame {} of {}  ", frame + 1, motion.size());
    try {
      live.set_poses(motion[frame].poses);
      const Evaluation& answer = live.evaluate(options);
      add_frame(live.scene(), frame + 1, motion[frame].name, answer, sweep);
      // Not on every frame: that may take longer than its answer.
      if (frame == 0)
        print_remarks(remarks(live.scene(), options, answer));
    } catch (const InputError& error) {
      throw InputError(
          fmt::format("{}: frame {} ({}): {}", request.scene, frame + 1, motion[frame].name, error.what()));
    }
    if (request.output) {
      write_whole({{*request.output, sweep.table}});
      folders->keep();
    }
  }
  if (isatty(STDERR_FILENO) != 0)
    fmt::print(stderr, "\n");
  if (!sweep.reached)
    fmt::print(stderr, "fringe: {}: an error of {} was not reached in every frame\n", request.scene,
               rtol_of(options));
  print(request.output ? fmt::format("{}: {} frames\n{}", request.output->string(), motion.size(),
                                     summary(live.scene(), motion, sweep))
                       : sweep.table);
  return sweep.reached ? answered : not_reached;
}

}  // namespace fringe::cli
