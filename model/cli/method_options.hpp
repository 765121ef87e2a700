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
  std::optional<std::string> method = {};  ///< none: auto with an rtol, else exact
  std::optional<double> tolerance = {};
  std::optional<double> rtol = {};
  std::optional<double> max_seconds = {};
  std::optional<std::string> prepared = {};  ///< a folder
  bool entries = false;
  bool derivatives = false;
};

/// Adds the options of `fringe capacitance` to a command, which fills in a request.
void add_method_options(CLI::App& command, MethodRequest& request);

/// Adds those that a sweep has, too, without `--method` itself.
void add_accuracy_options(CLI::App& command, MethodRequest& request);

/// Throws InputError for options of before, which says what to write now.
void refuse_former_options(const std::vector<std::string>& arguments);

/// Reads the options. Throws InputError for those that are unknown or cannot be combined.
EvaluationOptions options_of(const MethodRequest& request);

/// Returns the requests of several methods, each with those options that belong to it. Throws InputError for
/// an option that belongs to none of them.
std::vector<MethodRequest> requests_of(const std::vector<std::string>& methods, const MethodRequest& options);

}  // namespace fringe::cli
