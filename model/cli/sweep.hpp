#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "method_options.hpp"

namespace CLI {
class App;
}

namespace fringe::cli {

/// The arguments of `fringe sweep`.
struct SweepRequest {
  std::string scene;
  std::optional<std::string> motion;      ///< default: beside the scene
  std::vector<std::string> methods = {};  ///< none: auto with an rtol, else exact
  MethodRequest options;                  ///< of the methods, without their names
  std::optional<std::filesystem::path> output;
};

/// Returns the motion file of a scene: the one that is named, or SCENE.motion.toml beside SCENE.toml.
std::filesystem::path motion_file(const std::filesystem::path& scene,
                                  const std::optional<std::string>& named);

/// Adds the subcommand, which fills in a request.
CLI::App* add_sweep_command(CLI::App& program, SweepRequest& request);

/// Evaluates the readings in every frame of a motion by one or more methods. Prints a table as CSV; or writes
/// it to a file, whole after every frame, and prints between which frames a reading crosses its threshold.
/// Rows that the file holds already under the same key are kept. Of several methods, one without an answer in
/// a frame leaves the row empty. Returns the exit status: `not_reached` when one of the answers is less
/// accurate than asked for, or the time asked for ended before the motion; after Ctrl-C, with the frames that
/// are finished, `interrupted`. Throws InputError
/// when the input cannot be used or no method answers in a frame,
/// std::runtime_error when the file cannot be written.
int run_sweep(const SweepRequest& request);

}  // namespace fringe::cli
