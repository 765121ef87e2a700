#include "export/export.hpp"

#include <cstdio>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "export/matrix_files.hpp"
#include "export/panel_files.hpp"
#include "fringe/error.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/version.hpp"
#include "program.hpp"
#include "whole_files.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// The contents of the files to write, by path, and what is said about them.
struct ExportedFiles {
  std::map<fs::path, std::string> files;
  std::string about;
  bool reached = true;
};

ExportedFiles list_of(const ExportRequest& request) {
  if (request.method || request.rtol)
    throw InputError("--method and --rtol are options for .cir and .csv");
  const Scene scene = load_scene(request.source);
  PanelFiles panels;
  try {
    panels = panel_files(scene, request.target.stem().string());
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", request.source.string(), error.what()));
  }
  ExportedFiles result;
  result.about = fmt::format("{} conductors, {} panels in {} files beside it", panels.conductors,
                             panels.panels, panels.files.size());
  for (auto& [name, text] : panels.files)
    result.files[request.target.parent_path() / name] = std::move(text);
  result.files[request.target] = "* Conductors of a scene, by fringe export; lengths in m\n" + panels.list;
  return result;
}

ExportedFiles matrix_of(const ExportRequest& request, bool is_circuit) {
  EvaluationOptions options{.method = BoundaryElements{}, .rtol = request.rtol};
  if (request.method)
    options = with_method(options, *request.method);
  LiveScene live(load_scene(request.source));
  const Scene& scene = live.scene();
  try {
    const MaxwellMatrix& matrix = live.maxwell(options);
    const std::string remark = fmt::format("Maxwell matrix by {}, rtol {} {}", method_text(options),
                                           rtol_of(options), matrix.reached ? "reached" : "NOT reached");
    ExportedFiles result{{}, remark, matrix.reached};
    result.files[request.target] = is_circuit ? spice_subcircuit(matrix, grounded_conductors(scene, matrix),
                                                                 request.target.stem().string(), remark)
                                              : matrix_csv(matrix);
    return result;
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", request.source.string(), error.what()));
  }
}

}  // namespace

CLI::App* add_export_command(CLI::App& program, ExportRequest& request) {
  CLI::App* command = program.add_subcommand(
      "export", "Write the conductors of a scene as a list for FastCap and FasterCap, or their "
                "Maxwell matrix as a SPICE subcircuit or a table");
  command->set_version_flag("--version", version());
  command->add_option("SCENE", request.source, "The scene file (TOML)")->required();
  command
      ->add_option("FILE", request.target,
                   "The file to write: .lst, a list for FastCap and FasterCap, with its panels in .qui files "
                   "beside it; .cir, a SPICE subcircuit; .csv, the Maxwell matrix. Missing folders are made")
      ->required();
  command->add_option("--method", request.method,
                      "Of .cir and .csv: boundary-elements (if not given), reduced or auto");
  command->add_option(
      "--rtol", request.rtol,
      "Of .cir and .csv: the relative error to be reached in every entry (if not given, 0.01)");
  return command;
}

int run_export(const ExportRequest& request) {
  const std::string extension = request.target.extension().string();
  if (extension != ".lst" && extension != ".cir" && extension != ".csv")
    throw InputError(fmt::format("{}: must end in .lst, .cir or .csv", request.target.string()));
  MissingFolders folders(fs::absolute(request.target).parent_path());
  expect_writable(request.target);
  const ExportedFiles exported =
      extension == ".lst" ? list_of(request) : matrix_of(request, extension == ".cir");
  write_whole(exported.files);
  folders.keep();
  if (!exported.reached)
    fmt::print(stderr, "fringe: {}: the error asked for was not reached\n", request.source.string());
  print(fmt::format("{}: {}", request.target.string(), exported.about));
  return exported.reached ? answered : not_reached;
}

}  // namespace fringe::cli
