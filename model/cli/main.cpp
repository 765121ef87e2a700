#include <chrono>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "answers/answers.hpp"
#include "answers/json_text.hpp"
#include "export/export.hpp"
#include "fringe/error.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/scene_sensing.hpp"
#include "fringe/version.hpp"
#include "import_program.hpp"
#include "maxwell_table.hpp"
#include "program.hpp"
#include "reading_table.hpp"
#include "table_text.hpp"
#include "vtu_file.hpp"

namespace {

using namespace fringe;
using namespace fringe::answers;

using cli::answered, cli::not_reached, cli::print, cli::wrong_input;

/// The arguments of the command line.
struct Request {
  std::string scene;
  std::string method = "exact";
  std::string cone_method = "field_of_view";
  std::optional<std::string> plates;
  std::optional<std::string> faces;
  std::optional<std::string> correction;
  std::optional<std::string> output;
  std::optional<double> tolerance;
  std::optional<double> rtol;
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

/// The text of an answer, and whether the requested error was reached.
struct Answer {
  std::string text;
  bool reached = true;
};

EvaluationOptions options_of(const Request& request) {
  EvaluationOptions options{.method = parse_method(request.method)};
  if (request.plates)
    options.plates = parse_plate_rule(*request.plates);
  if (request.faces)
    options.faces = parse_face_rule(*request.faces);
  if (request.correction)
    options.correction = parse_correction(*request.correction);
  options.tolerance = request.tolerance;
  options.rtol = request.rtol;
  validate(options);
  if (request.output && !is_integral(options.method))
    throw InputError(
        fmt::format("--output is an option of the triangle-integral methods, not of {}", request.method));
  return options;
}

/// Formats an evaluation as a table.
std::string table_of(const Evaluation& answer, const EvaluationOptions& options, double seconds) {
  const std::string heading = std::holds_alternative<Recommended>(options.method)
                                  ? fmt::format("recommended: answered by {}\n", answer.answered_by)
                                  : std::string();
  return heading +
         (answer.matrix ? cli::maxwell_table(*answer.matrix, {answer.answered_by, rtol_of(options)}, seconds)
                        : cli::capacitance_table(answer.capacitance, used_options(options), seconds)) +
         cli::reading_table(answer.readings);
}

Answer answer_capacitance(const Request& request) {
  const EvaluationOptions options = options_of(request);
  LiveScene live(load_scene(request.scene));
  const auto start = std::chrono::steady_clock::now();
  const Evaluation& answer =
      of_file(request.scene, [&]() -> const Evaluation& { return live.evaluate(options); });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  if (request.output)
    cli::write_vtu(live.scene(), integral_options(options), *request.output);
  if (!answer.reached)
    fmt::print(stderr, "fringe: {}: an error of {} was not reached\n", request.scene, rtol_of(options));
  return {request.json ? json_text(capacitance_answer(answer, options, elapsed.count()))
                       : table_of(answer, options, elapsed.count()),
          answer.reached};
}

std::string answer_collide(const Request& request) {
  const Scene scene = load_scene(request.scene);
  const SceneCollision answer = collide(scene);
  return request.json ? json_text(collision_answer(answer, scene)) : cli::collision_table(answer, scene);
}

std::string answer_info(const Request& request) {
  const SceneInfo info = scene_info(load_scene(request.scene));
  return request.json ? json_text(info_answer(info)) : cli::info_table(info);
}

std::string answer_sense(const Request& request) {
  const std::vector<DistanceReading> readings =
      sense(load_scene(request.scene), parse_cone_method(request.cone_method));
  return request.json ? json_text(sensing_answer(readings)) : cli::readings_table(readings);
}

int run(int argument_count, char** arguments) {
  if (argument_count > 1 && arguments[1] == std::string_view("import"))
    return cli::run_import(argument_count, arguments);
  CLI::App program("fringe: what a capacitive proximity sensor feels of the objects around it");
  program.set_version_flag("--version", version());
  program.require_subcommand(1);
  Request request;
  CLI::App* capacitance_command = add_command(
      program, request, "capacitance",
      "Capacitance and output voltage of every sensor by the triangle-integral model, or the Maxwell "
      "matrix by boundary elements");
  capacitance_command
      ->add_option("--method", request.method,
                   "exact, split:N or gauss:K; or boundary-elements, for every shape, or reduced:K, the same "
                   "in microseconds for moving scenes; or recommended, the first of reduced:K, "
                   "boundary-elements and the correction formula that states the error asked for")
      ->capture_default_str();
  capacitance_command
      ->add_option("--plates", request.plates,
                   "sum: every plate of a sensor counts every point; nearest: only the nearest plate does")
      ->default_str("sum");
  capacitance_command
      ->add_option("--faces", request.faces,
                   "all, or facing: only triangles whose outward side sees the plate, and those in contact")
      ->default_str("all");
  capacitance_command
      ->add_option("--tolerance", request.tolerance,
                   "What may be left out of a sensor's total, relative to it; only with exact")
      ->default_str("0");
  capacitance_command
      ->add_option(
          "--correction", request.correction,
          "none, or what takes the place of the integral: formula or recommended (model/CORRECTIONS.md)")
      ->default_str("none");
  capacitance_command
      ->add_option("--output", request.output,
                   "Also write the triangles with what each adds to every sensor's capacitance, for ParaView")
      ->type_name("FILE.vtu")
      ->check([](const std::string& name) {
        return name.ends_with(".vtu") ? std::string() : fmt::format("'{}' does not end in .vtu", name);
      });
  capacitance_command->add_option(
      "--rtol", request.rtol,
      "The relative error to be reached in every entry; only with boundary-elements (if not given "
      "0.001), reduced:1, 2, 3 (0.01, 0.001, 0.0003) and recommended (0.01)");
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
  if (capacitance_command->parsed()) {
    const auto [text, reached] = answer_capacitance(request);
    print(text);
    return reached ? answered : not_reached;
  }
  print(collide_command->parsed() ? answer_collide(request)
        : sense_command->parsed() ? answer_sense(request)
                                  : answer_info(request));
  return answered;
}

}  // namespace

int main(int argument_count, char** arguments) {
  return fringe::cli::run_program(run, argument_count, arguments);
}
