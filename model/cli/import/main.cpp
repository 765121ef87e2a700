#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/version.hpp"
#include "import/formats.hpp"
#include "import/scene_file.hpp"
#include "program.hpp"

// The program that `fringe import` starts. It is one of its own because the libraries that read models take a
// tenth of a second to load, and because a damaged file may end them.
namespace fringe::cli {
namespace {

/// The arguments of `fringe import`. Those that are given must apply to the source's format.
struct ImportRequest {
  std::filesystem::path source;
  std::filesystem::path target;
  std::optional<std::string> geometry;               ///< of URDF: collision (default) or visual
  std::optional<std::string> missing;                ///< of URDF: refuse (default) or leave-out
  std::vector<std::filesystem::path> package_paths;  ///< of URDF
  std::vector<std::string> joints;                   ///< of URDF: lists NAME=POSITION,…; rad or m
  std::optional<double> deflection;                  ///< of STEP: m
};

/// The result of an import: a sentence about the files written, and the warnings, a line each.
struct ImportReport {
  std::string written;
  std::vector<std::string> warnings;
};

/// Reads lists of positions, such as "a=0.3,b=-1.2".
std::map<std::string, double> positions(const std::vector<std::string>& lists) {
  std::map<std::string, double> result;
  for (const std::string& list : lists)
    for (std::size_t begin = 0; begin <= list.size();) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      const std::string item = list.substr(begin, end - begin);
      const std::size_t equals = item.rfind('=');
      const auto refuse = [&](std::string_view reason) {
        throw InputError(fmt::format("--joints: \"{}\" {}", item, reason));
      };
      if (equals == std::string::npos || equals == 0)
        refuse("is not NAME=POSITION");
      const std::string number = item.substr(equals + 1);
      std::size_t read = 0;
      double position = NAN;
      try {
        position = std::stod(number, &read);
      } catch (const std::exception&) {
        read = 0;
      }
      if (number.empty() || read != number.size() || !std::isfinite(position))
        refuse("has no finite number as position");
      if (!result.emplace(item.substr(0, equals), position).second)
        refuse("sets a joint again");
      begin = end + 1;
    }
  return result;
}

/// Refuses options that would change nothing.
void require_urdf(const ImportRequest& request, bool is_urdf) {
  if (!is_urdf &&
      (request.geometry || request.missing || !request.package_paths.empty() || !request.joints.empty()))
    throw InputError("--geometry, --missing, --package-path and --joints are options for URDF");
}

void require_step(const ImportRequest& request, bool is_step) {
  if (!is_step && request.deflection)
    throw InputError("--deflection is an option for STEP");
  if (request.deflection && (!(*request.deflection > 0) || !std::isfinite(*request.deflection)))
    throw InputError(fmt::format("--deflection: must be greater than 0, not {}", *request.deflection));
}

std::string about(const StepImport& step, bool is_default) {
  return fmt::format("; triangles up to {:.2g} m off the surface, {:.2g} m asked for{}", step.error,
                     step.deflection,
                     is_default ? fmt::format(" ({} of the diagonal)", default_deflection) : "");
}

/// Imports a robot or a model: writes a scene file, and mesh files beside it. Throws InputError, with nothing
/// written, when the source cannot be used.
ImportReport import_scene(const ImportRequest& request) {
  const std::string extension = extension_of(request.source);
  const bool is_step = extension == ".step" || extension == ".stp";
  require_urdf(request, extension == ".urdf");
  require_step(request, is_step);
  ImportReport report;
  std::string remark;
  Scene scene;
  if (extension == ".urdf") {
    const UrdfRequest robot{parse_urdf_geometry(request.geometry.value_or("collision")),
                            parse_missing_mesh(request.missing.value_or("refuse")), request.package_paths,
                            positions(request.joints)};
    scene = read_urdf(request.source, robot, report.warnings);
  } else if (extension == ".gltf" || extension == ".glb") {
    scene = read_gltf(request.source);
  } else if (is_model_file(request.source)) {
    scene = read_model(request.source, report.warnings);
  } else if (is_step) {
    StepImport step = read_step(request.source, request.deflection);
    remark = about(step, !request.deflection);
    scene = std::move(step.scene);
  } else if (extension == ".lst" || extension == ".qui") {
    scene = read_panel_list(request.source, report.warnings);
  } else {
    throw InputError(
        fmt::format("{}: must end in .urdf, .gltf, .glb, .dae, .obj, .3mf, .step, .stp, .lst or .qui{}",
                    request.source.string(),
                    extension == ".xacro" ? "; xacro makes URDF of it: xacro FILE > robot.urdf" : ""));
  }
  const auto meshes = std::count_if(scene.objects.begin(), scene.objects.end(), [](const Object& object) {
    return std::holds_alternative<Mesh>(object.shape);
  });
  const auto joints = std::count_if(scene.links.begin(), scene.links.end(),
                                    [](const Link& link) { return link.joint.has_value(); });
  write_scene_file(scene, request.target, request.source.filename().string());
  report.written = fmt::format("{}: {} links, {}{} objects, {} of them meshes{}", request.target.string(),
                               scene.links.size(), joints > 0 ? fmt::format("{} joints, ", joints) : "",
                               scene.objects.size(), meshes, remark);
  return report;
}

}  // namespace
}  // namespace fringe::cli

namespace {

using namespace fringe;

using cli::answered, cli::wrong_input;

void add_options(CLI::App& program, cli::ImportRequest& request) {
  program.set_version_flag("--version", version());
  program
      .add_option("SOURCE", request.source,
                  "A .urdf, .gltf, .glb, .dae, .obj, .3mf, .step, .stp, .lst or .qui file")
      ->required();
  program
      .add_option("SCENE", request.target,
                  "The scene file to write (TOML); meshes go to a folder beside it, missing folders are made")
      ->required();
  program.add_option(
      "--geometry", request.geometry,
      "collision or visual: which geometry of a robot's links to take; if not given collision");
  program.add_option("--missing", request.missing,
                     "refuse or leave-out: what becomes of a robot with a mesh that is missing or cannot be "
                     "read; if not given refuse");
  program
      .add_option("--package-path", request.package_paths,
                  "A folder that holds packages which package:// names; may be given several times")
      ->allow_extra_args(false);
  program
      .add_option("--joints", request.joints,
                  "Positions of a robot's joints, NAME=POSITION,… in rad or m; 0 for all others")
      ->allow_extra_args(false);
  program.add_option(
      "--deflection", request.deflection,
      "How far (m) the triangles of STEP may be from its surfaces; if not given 0.001 of the diagonal of "
      "the bounding box");
}

int run(int argument_count, char** arguments) {
  CLI::App program("Write a scene file with the links and bodies of a robot (URDF) or a model (glTF, "
                   "COLLADA, OBJ, 3MF, STEP), or the conductors of a FastCap or FasterCap list",
                   "fringe import");
  cli::ImportRequest request;
  add_options(program, request);
  try {
    program.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    // Help and version also end in an "error", one with exit code 0.
    return program.exit(error, std::cout, std::cerr) == 0 ? answered : wrong_input;
  }
  const cli::ImportReport report = cli::import_scene(request);
  for (const std::string& warning : report.warnings)
    fmt::print(stderr, "fringe: warning: {}\n", warning);
  cli::print(report.written);
  return answered;
}

}  // namespace

int main(int argument_count, char** arguments) {
  return fringe::cli::run_program(run, argument_count, arguments);
}
