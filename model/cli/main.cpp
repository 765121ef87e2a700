#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "answer_tables.hpp"
#include "answers/answers.hpp"
#include "answers/json_text.hpp"
#include "export/export.hpp"
#include "fringe/error.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/motion.hpp"
#include "fringe/progress.hpp"
#include "fringe/remarks.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/scene_sensing.hpp"
#include "fringe/version.hpp"
#include "interruption.hpp"
#include "method_options.hpp"
#include "program.hpp"
#include "progress.hpp"
#include "sweep.hpp"
#include "vtu_file.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Finds the program beside this one, where it is built, or where it is installed.
fs::path find_program() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path place : {"", FRINGE_LIBEXEC_FROM_BIN})
    if (fs::path program = folder / place / "fringe-import"; fs::is_regular_file(program))
      return program;
  throw std::runtime_error(fmt::format("there is no program fringe-import in {} or {}", folder.string(),
                                       (folder / FRINGE_LIBEXEC_FROM_BIN).lexically_normal().string()));
}

/// Runs the program of `fringe import` with the arguments after `import` and returns its exit status. One
/// that a signal ends, as a damaged file may do to the libraries that read it, is reported as wrong input
/// (2). Throws std::runtime_error when the program is not there.
int run_import(int argument_count, char** arguments) {
  const fs::path program = find_program();
  std::string name = program.string();
  std::vector<char*> forwarded{name.data()};
  forwarded.insert(forwarded.end(), arguments + 2, arguments + argument_count);
  forwarded.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, forwarded.data(), environ);
      error != 0)
    throw std::runtime_error(fmt::format("{}: cannot be started", program.string()));
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR)
      throw std::runtime_error(fmt::format("{}: cannot be waited for", program.string()));
  if (WIFEXITED(status))
    return WEXITSTATUS(status);
  /// The shell's status of a program that a signal ended is larger than the signal's number by this.
  constexpr int by_signal = 128;
  const int ending = WTERMSIG(status);
  if (ending == SIGINT || ending == SIGTERM || ending == SIGKILL || ending == SIGPIPE || ending == SIGHUP)
    return by_signal + ending;
  fmt::print(stderr,
             "fringe: import {}: the file cannot be read: the library that reads it ended by signal {}\n",
             fmt::join(arguments + 2, arguments + argument_count, " "), ending);
  return wrong_input;
}

}  // namespace
}  // namespace fringe::cli

namespace {

using namespace fringe;
using namespace fringe::answers;

using cli::answered, cli::not_reached, cli::print, cli::wrong_input;

/// The arguments of the command line.
struct Request {
  std::string scene;
  cli::MethodRequest method;
  std::optional<std::string> frame;
  std::optional<std::string> motion;
  std::string cone_method = "field_of_view";
  std::optional<std::string> output;
  bool json = false;
};

CLI::App* add_command(CLI::App& program, Request& request, const std::string& name,
                      const std::string& description) {
  CLI::App* command = program.add_subcommand(name, description);
  command->set_version_flag("--version", version());
  command->add_option("SCENE", request.scene, "The scene file (TOML)")->required();
  command->add_flag("--json", request.json, "Print one JSON document instead of a table");
  return command;
}

/// Runs an action and puts the name of the scene file in front of its InputErrors.
template <typename Action>
decltype(auto) of_file(const std::string& file, const Action& action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file, error.what()));
  }
}

/// Prints the remarks on a scene, and adds them to an answer about it.
Json with_printed_remarks(Json answer, const Scene& scene) {
  const std::vector<std::string> found = remarks(scene);
  cli::print_remarks(found);
  return with_remarks(std::move(answer), found);
}

/// The text of an answer, and the exit status that goes with it.
struct Answer {
  std::string text;
  int status = answered;
};

/// Formats an evaluation as a table.
std::string table_of(const Evaluation& answer, const EvaluationOptions& options, double seconds) {
  const std::string heading = std::holds_alternative<Auto>(method_of(options))
                                  ? fmt::format("auto: answered by {}\n", answer.answered_by)
                                  : std::string();
  return heading +
         (answer.matrix ? cli::maxwell_table(answer, options, seconds)
                        : cli::capacitance_table(answer, options, seconds)) +
         cli::reading_table(answer.readings);
}

/// Reads the scene, in the poses of the frame that is asked for.
LiveScene live_scene(const Request& request) {
  if (request.motion && !request.frame)
    throw InputError("--motion without --frame: name the frame, or see fringe sweep");
  LiveScene live(load_scene(request.scene));
  if (request.frame) {
    const std::filesystem::path file = cli::motion_file(request.scene, request.motion);
    const std::vector<Frame> motion = load_motion(file, live.scene());
    of_file(file.string(), [&] { live.set_poses(motion[find_frame(motion, *request.frame)].poses); });
  }
  return live;
}

Answer answer_capacitance(const Request& request) {
  EvaluationOptions options = cli::options_of(request.method);
  const Method method = method_of(options);
  if (request.output && !is_integral(method))
    throw InputError(
        fmt::format("--output is an option of exact, split:N and gauss:K, not of {}", to_string(method)));
  LiveScene live = live_scene(request);
  // The others answer before one could press Ctrl-C, which ends them as it ends any program.
  std::optional<cli::CommandInterruption> interruption;
  if (!is_integral(method))
    interruption.emplace();
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto is_late = [&] { return options.max_seconds && elapsed() >= *options.max_seconds; };
  const auto reason = [&] {
    return interruption && interruption->is_asked_for()
               ? std::string("interrupted")
               : fmt::format("stopped after {:g} s", options.max_seconds.value_or(elapsed()));
  };
  try {
    std::optional<cli::ProgressLine> progress;
    std::optional<ProgressScope> preparation;
    if (!is_integral(method)) {
      progress.emplace(rtol_of(options));
      options.before_refinement = [&](const RefinementLevel& level) { progress->show(level); };
      preparation.emplace([&](const std::string& text) { progress->show(text); });
    }
    const Evaluation& answer =
        of_file(request.scene, [&]() -> const Evaluation& { return live.evaluate(options); });
    preparation.reset();
    progress.reset();
    const double seconds = elapsed();
    if (request.output)
      cli::write_vtu(live.scene(), options, *request.output);
    const std::vector<std::string> found = remarks(live.scene(), options, answer);
    cli::print_remarks(found);
    const std::string text =
        request.json ? json_text(with_remarks(capacitance_answer(answer, options, seconds), found))
                     : table_of(answer, options, seconds);
    if (answer.reached)
      return {text, answered};
    const bool is_asked_to_end = interruption && interruption->is_asked_for();
    fmt::print(stderr, "fringe: {}: {}an error of {} was not reached\n", request.scene,
               is_asked_to_end || is_late() ? reason() + ": " : "", rtol_of(options));
    return {text, is_asked_to_end ? cli::interrupted : not_reached};
  } catch (const Interrupted&) {
    fmt::print(stderr, "fringe: {}: {} before there was an answer\n", request.scene, reason());
    return {"", interruption && interruption->is_asked_for() ? cli::interrupted : not_reached};
  }
}

std::string answer_collide(const Request& request) {
  const Scene scene = load_scene(request.scene);
  const SceneCollision answer = collide(scene);
  const Json described = with_printed_remarks(collision_answer(answer, scene), scene);
  return request.json ? json_text(described) : cli::collision_table(answer, scene);
}

std::string answer_info(const Request& request) {
  const Scene scene = load_scene(request.scene);
  const SceneInfo info = scene_info(scene);
  const Json described = with_printed_remarks(info_answer(info, scene), scene);
  return request.json ? json_text(described) : cli::info_table(info, scene);
}

std::string answer_sense(const Request& request) {
  const Scene scene = load_scene(request.scene);
  const std::vector<DistanceReading> readings = sense(scene, parse_cone_method(request.cone_method));
  const Json described = with_printed_remarks(sensing_answer(readings), scene);
  return request.json ? json_text(described) : cli::readings_table(readings);
}

int run(int argument_count, char** arguments) {
  if (argument_count > 1 && arguments[1] == std::string_view("import"))
    return cli::run_import(argument_count, arguments);
  cli::refuse_former_options({arguments + 1, arguments + argument_count});
  CLI::App program("fringe: what a capacitive proximity sensor feels of the objects around it");
  program.set_version_flag("--version", version());
  program.require_subcommand(1);
  Request request;
  CLI::App* capacitance_command = add_command(
      program, request, "capacitance",
      "What every sensor feels, and its readings, by the triangle-integral model, by boundary elements or by "
      "what is between them");
  cli::add_method_options(*capacitance_command, request.method);
  capacitance_command->add_option("--frame", request.frame,
                                  "The frame of a motion, by its name or number, whose poses the links take");
  capacitance_command
      ->add_option("--motion", request.motion,
                   "The motion file (if not given, SCENE.motion.toml); only with --frame")
      ->type_name("FILE");
  capacitance_command
      ->add_option("--output", request.output,
                   "Also write the triangles with what each adds to every sensor's capacitance, for ParaView")
      ->type_name("FILE.vtu")
      ->check([](const std::string& name) {
        return name.ends_with(".vtu") ? std::string() : fmt::format("'{}' does not end in .vtu", name);
      });
  CLI::App* sense_command =
      add_command(program, request, "sense", "The closest point that every distance sensor sees");
  sense_command
      ->add_option("--method", request.cone_method,
                   "field_of_view: by the angle to the cone's axis; cone_equation: in the cone's frame")
      ->capture_default_str();
  const CLI::App* const collide_command =
      add_command(program, request, "collide",
                  "Which objects collide, and which have only their bounding boxes in common");
  add_command(program, request, "info", "Counts, areas, volumes and bounding boxes");
  // Listed for the help only: run_import runs it.
  program.add_subcommand(
      "import", "Write a scene file with the links and bodies of a robot (URDF) or a model (glTF, COLLADA, "
                "OBJ, 3MF, STEP), or the conductors of a FastCap or FasterCap list");
  cli::ExportRequest export_request;
  cli::SweepRequest sweep_request;
  const CLI::App* const sweep_command = cli::add_sweep_command(program, sweep_request);
  const CLI::App* const export_command = cli::add_export_command(program, export_request);
  try {
    program.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    if (argument_count > 1 && arguments[1][0] != '-' && program.get_subcommands().empty()) {
      fmt::print(stderr, "fringe: there is no command '{}': see fringe --help\n", arguments[1]);
      return wrong_input;
    }
    // Help and version also end in an "error", one with exit code 0.
    return program.exit(error, std::cout, std::cerr) == 0 ? answered : wrong_input;
  }

  if (export_command->parsed())
    return cli::run_export(export_request);
  if (sweep_command->parsed())
    return cli::run_sweep(sweep_request);
  if (capacitance_command->parsed()) {
    const auto [text, status] = answer_capacitance(request);
    if (!text.empty())
      print(text);
    return status;
  }
  print(collide_command->parsed() ? answer_collide(request)
        : sense_command->parsed() ? answer_sense(request)
                                  : answer_info(request));
  return answered;
}

}  // namespace

int main(int argument_count, char** arguments) {
#ifdef __GLIBC__
  // Each level of boundary elements needs the memory that the last one has freed. If the allocator gave it
  // back to the system in between, up to a third of the time would go into page faults.
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
#endif
  return fringe::cli::run_program(run, argument_count, arguments);
}
