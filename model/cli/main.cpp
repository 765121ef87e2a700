#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/reduced_capacitance.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/scene_sensing.hpp"
#include "fringe/version.hpp"
#include "import_program.hpp"
#include "json_text.hpp"
#include "maxwell_text.hpp"
#include "table_text.hpp"
#include "vtu_file.hpp"

namespace {

using namespace fringe;

enum ExitCode { answered = 0, failed = 1, wrong_input = 2, not_reached = 3 };

/// The arguments of the command line.
struct Request {
  std::string scene;
  std::string method = "exact";
  std::string cone_method = "field_of_view";
  std::string plates = "sum";
  std::string faces = "all";
  std::string correction = "none";
  std::optional<std::string> output;
  double tolerance = 0;
  double rtol = BoundaryElementOptions{}.rtol;
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
auto of_file(const std::string& file, const Action& action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file, error.what()));
  }
}

std::string answer_capacitance(const Request& request) {
  const CapacitanceOptions options{parse_method(request.method), parse_plate_rule(request.plates),
                                   parse_face_rule(request.faces), request.tolerance,
                                   parse_correction(request.correction)};
  const Scene scene = load_scene(request.scene);
  const auto start = std::chrono::steady_clock::now();
  const SceneCapacitance answer = of_file(request.scene, [&] { return capacitance(scene, options); });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  if (request.output)
    cli::write_vtu(scene, options, *request.output);
  return request.json ? cli::capacitance_json(answer, options, elapsed.count())
                      : cli::capacitance_table(answer, options, elapsed.count());
}

/// The text of the answer, and whether the requested error was reached.
struct MaxwellAnswer {
  std::string text;
  bool reached;
};

/// Computes a Maxwell matrix. `reduced_steps` is empty for the method boundary-elements.
MaxwellAnswer answer_maxwell(const Request& request, std::optional<int> reduced_steps) {
  const Scene scene = load_scene(request.scene);
  const auto start = std::chrono::steady_clock::now();
  const MaxwellMatrix matrix = of_file(request.scene, [&] {
    return reduced_steps ? reduced_capacitance(scene, {.steps = *reduced_steps, .rtol = request.rtol})
                         : maxwell(scene, {.rtol = request.rtol});
  });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  const cli::MaxwellRequest asked{request.method, request.rtol};
  return {request.json ? cli::maxwell_json(scene, matrix, asked, elapsed.count())
                       : cli::maxwell_table(matrix, asked, elapsed.count()),
          matrix.reached};
}

/// Refuses options that the method does not use.
void refuse_options_of_other_methods(const CLI::App& command, const std::string& method,
                                     bool boundary_elements) {
  for (const char* option : {"--plates", "--faces", "--tolerance", "--correction", "--output"})
    if (boundary_elements && command.count(option) > 0)
      throw InputError(
          fmt::format("{} is an option of the triangle-integral methods, not of {}", option, method));
  if (!boundary_elements && command.count("--rtol") > 0)
    throw InputError("--rtol is an option of the method boundary-elements, and of reduced:K");
}

std::string answer_collide(const Request& request) {
  const Scene scene = load_scene(request.scene);
  const SceneCollision answer = collide(scene);
  return request.json ? cli::collision_json(answer, scene) : cli::collision_table(answer, scene);
}

std::string answer_info(const Request& request) {
  const SceneInfo info = scene_info(load_scene(request.scene));
  return request.json ? cli::info_json(info) : cli::info_table(info);
}

std::string answer_sense(const Request& request) {
  const std::vector<DistanceReading> readings =
      sense(load_scene(request.scene), parse_cone_method(request.cone_method));
  return request.json ? cli::readings_json(readings) : cli::readings_table(readings);
}

void print(std::string answer) {
  if (answer.back() != '\n')
    answer += '\n';
  std::cout << answer << std::flush;
  if (!std::cout)
    throw std::runtime_error("the answer could not be written");
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
                   "in microseconds for moving scenes")
      ->capture_default_str();
  capacitance_command
      ->add_option("--plates", request.plates,
                   "sum: every plate of a sensor counts every point; nearest: only the nearest plate does")
      ->capture_default_str();
  capacitance_command
      ->add_option("--faces", request.faces,
                   "all, or facing: only triangles whose outward side sees the plate, and those in contact")
      ->capture_default_str();
  capacitance_command
      ->add_option("--tolerance", request.tolerance,
                   "What may be left out of a sensor's total, relative to it; only with exact")
      ->capture_default_str();
  capacitance_command
      ->add_option(
          "--correction", request.correction,
          "none, or what takes the place of the integral: a name of model/CORRECTIONS.md, or recommended")
      ->capture_default_str();
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
      "0.001) and reduced:1, 2, 3 (0.01, 0.001, 0.0003)");
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
                "OBJ, 3MF, STEP)");
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

  const std::optional<int> reduced_steps =
      capacitance_command->parsed() ? parse_reduced_steps(request.method) : std::nullopt;
  const bool boundary_elements =
      capacitance_command->parsed() && (reduced_steps || request.method == "boundary-elements");
  if (capacitance_command->parsed())
    refuse_options_of_other_methods(*capacitance_command, request.method, boundary_elements);
  if (boundary_elements) {
    if (reduced_steps && capacitance_command->count("--rtol") == 0)
      request.rtol = rtol_of({.steps = *reduced_steps, .rtol = {}});
    const auto [text, reached] = answer_maxwell(request, reduced_steps);
    print(text);
    if (!reached)
      fmt::print(stderr, "fringe: {}: an error of {} was not reached\n", request.scene, request.rtol);
    return reached ? answered : not_reached;
  }
  print(capacitance_command->parsed() ? answer_capacitance(request)
        : collide_command->parsed()   ? answer_collide(request)
        : sense_command->parsed()     ? answer_sense(request)
                                      : answer_info(request));
  return answered;
}

}  // namespace

int main(int argument_count, char** arguments) {
  try {
    return run(argument_count, arguments);
  } catch (const InputError& error) {
    fmt::print(stderr, "fringe: {}\n", error.what());
    return wrong_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "fringe: {}\n", error.what());
    return failed;
  }
}
