#include <cstdio>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/version.hpp"
#include "import/import.hpp"
#include "program.hpp"

// The program that `fringe import` starts. It is one of its own because the libraries that read models take a
// tenth of a second to load, and because a damaged file may end them.
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
