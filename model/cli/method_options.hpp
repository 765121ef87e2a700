#pragma once

#include <optional>
#include <string>

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
};

/// Adds the options to a command, which fills in a request.
void add_method_options(CLI::App& command, MethodRequest& request);

/// Reads the options. Throws InputError for those that are unknown or cannot be combined.
EvaluationOptions options_of(const MethodRequest& request);

}  // namespace fringe::cli
