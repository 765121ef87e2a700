#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fringe/evaluation.hpp"

namespace CLI {
class App;
}

namespace fringe::cli {

/// The options of a command that choose the method, as they are written.
struct MethodRequest {
  std::string method = "exact";
  std::optional<std::string> plates = {};
  std::optional<std::string> faces = {};
  std::optional<std::string> correction = {};
  std::optional<double> tolerance = {};
  std::optional<double> rtol = {};
  std::optional<std::string> prepared = {};  ///< a folder
  bool only_readings = false;
  bool derivatives = false;
};

/// Adds the options to a command, which fills in a request.
void add_method_options(CLI::App& command, MethodRequest& request);

/// Adds the options that refine a method, without `--method` itself.
void add_refining_options(CLI::App& command, MethodRequest& request);

/// Reads the options. A method may be written with what refines it, as in studies: "exact+nearest+facing" is
/// exact with these plates and faces, "formula" the correction. Throws InputError for those that are unknown
/// or cannot be combined.
EvaluationOptions options_of(const MethodRequest& written);

/// Returns the requests of several methods, each with those options that belong to it. Throws InputError for
/// an option that belongs to none of them.
std::vector<MethodRequest> requests_of(const std::vector<std::string>& methods, const MethodRequest& options);

}  // namespace fringe::cli
