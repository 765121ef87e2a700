#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace fringe::cli {

/// The arguments of `fringe export`. The target's extension says what is written: .lst, .cir or .csv.
struct ExportRequest {
  std::filesystem::path source;
  std::filesystem::path target;
  std::optional<std::string> method;  ///< of .cir and .csv; default boundary-elements
  std::optional<double> rtol;         ///< of .cir and .csv
};

/// Adds the subcommand, which fills in a request.
CLI::App* add_export_command(CLI::App& program, ExportRequest& request);

/// Writes a scene's conductors as a list for FastCap and FasterCap, or its Maxwell matrix as a SPICE
/// subcircuit or a table: all files whole, or none. Makes missing folders and prints a sentence about the
/// files. Returns the exit status: `not_reached` when the matrix is less accurate than asked for. Throws
/// InputError when the scene cannot be exported, std::runtime_error when a file cannot be written.
int run_export(const ExportRequest& request);

}  // namespace fringe::cli
