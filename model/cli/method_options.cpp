#include "method_options.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::cli {
namespace {

/// Sets an option that a method is written with. Throws InputError if it is given in both ways.
void set(std::optional<std::string>& option, const std::string& method, const char* name, const char* value) {
  if (option && *option != value)
    throw InputError(fmt::format("method '{}' and --{} {} contradict each other", method, name, *option));
  option = value;
}

/// Tells whether an accuracy can be asked of a method that is written out by options.
bool takes_rtol(const MethodRequest& request) {
  return !is_integral(parse_method(request.method)) || request.correction == "formula";
}

/// Tells whether a method keeps what it prepares in a folder.
bool keeps_prepared(const MethodRequest& request) {
  return request.rtol && (request.method == "recommended" || request.correction == "formula");
}

/// Returns a request whose method is written out by options: "formula" as the correction of that name,
/// "+nearest" and "+facing" as plates and faces.
MethodRequest expanded(const MethodRequest& written) {
  MethodRequest request = written;
  const auto ends_with = [&](const std::string& rule) {
    const bool found = request.method.ends_with(rule);
    if (found)
      request.method.resize(request.method.size() - rule.size());
    return found;
  };
  if (ends_with("+facing"))
    set(request.faces, written.method, "faces", "facing");
  if (ends_with("+nearest"))
    set(request.plates, written.method, "plates", "nearest");
  if (request.method == "formula") {
    set(request.correction, written.method, "correction", "formula");
    request.method = "exact";
  }
  return request;
}

}  // namespace

void add_method_options(CLI::App& command, MethodRequest& request) {
  command
      .add_option("--method", request.method,
                  "exact, split:N or gauss:K; or boundary-elements, for every shape, or reduced:K, the same "
                  "in microseconds for moving scenes; or recommended, the first of reduced:K, "
                  "boundary-elements and the correction formula that states the error asked for; or formula; "
                  "+nearest and +facing after a method stand for --plates and --faces")
      ->capture_default_str();
  add_refining_options(command, request);
  command.add_flag("--only-readings", request.only_readings,
                   "Reach the error in the readings and their changes, not in every entry as well; only with "
                   "boundary-elements");
  command.add_flag("--derivatives", request.derivatives,
                   "Also the derivatives of the readings' changes with respect to the pose of every link; "
                   "only with exact, boundary-elements, reduced:K and the correction formula with --rtol");
}

void add_refining_options(CLI::App& command, MethodRequest& request) {
  command
      .add_option("--plates", request.plates,
                  "sum: every plate of a sensor counts every point; nearest: only the nearest plate does")
      ->default_str("sum");
  command
      .add_option("--faces", request.faces,
                  "all, or facing: only triangles whose outward side sees the plate, and those in contact")
      ->default_str("all");
  command
      .add_option("--tolerance", request.tolerance,
                  "What may be left out of a sensor's total, relative to it; only with exact")
      ->default_str("0");
  command
      .add_option(
          "--correction", request.correction,
          "none, or what takes the place of the integral: formula or recommended (model/CORRECTIONS.md)")
      ->default_str("none");
  command.add_option(
      "--rtol", request.rtol,
      "The relative error to be reached in every entry; only with boundary-elements (if not given "
      "0.001), reduced:1, 2, 3 (0.01, 0.001, 0.0003), recommended (0.01) and, in the changes of readings, "
      "the "
      "correction formula");
  command
      .add_option(
          "--prepared", request.prepared,
          "Keep what takes long to prepare in this folder, and take from it what is there of the same "
          "scene; only with the correction formula or recommended, and --rtol")
      ->type_name("FOLDER");
}

EvaluationOptions options_of(const MethodRequest& written) {
  const MethodRequest request = expanded(written);
  EvaluationOptions options{.method = parse_method(request.method)};
  if (request.plates)
    options.plates = parse_plate_rule(*request.plates);
  if (request.faces)
    options.faces = parse_face_rule(*request.faces);
  if (request.correction)
    options.correction = parse_correction(*request.correction);
  options.tolerance = request.tolerance;
  options.rtol = request.rtol;
  if (request.only_readings) {
    if (!std::holds_alternative<BoundaryElements>(options.method))
      throw InputError(fmt::format("--only-readings is an option of boundary-elements, not of {}",
                                   to_string(options.method)));
    options.entries = Entries::of_readings;
  }
  options.derivatives = request.derivatives;
  if (request.prepared)
    options.prepared = *request.prepared;
  validate(options);
  return options;
}

std::vector<MethodRequest> requests_of(const std::vector<std::string>& methods,
                                       const MethodRequest& options) {
  std::vector<MethodRequest> requests;
  std::vector<bool> integral;
  for (const std::string& method : methods) {
    requests.push_back(options);
    requests.back().method = method;
    integral.push_back(is_integral(parse_method(expanded({.method = method}).method)));
  }
  const bool any_integral = std::ranges::count(integral, true) > 0;
  for (std::size_t k = 0; k < requests.size(); ++k)
    if (!integral[k] && any_integral)
      requests[k] = {
          .method = requests[k].method, .rtol = requests[k].rtol, .prepared = requests[k].prepared};
  // An option that no method has stays, so that it is refused.
  const auto leave_to = [&](const auto& has, const auto& option) {
    const auto has_it = [&](const MethodRequest& request) { return has(expanded(request)); };
    if (std::ranges::any_of(requests, has_it))
      for (MethodRequest& request : requests)
        if (!has_it(request))
          (request.*option).reset();
  };
  leave_to(takes_rtol, &MethodRequest::rtol);
  leave_to(keeps_prepared, &MethodRequest::prepared);
  for (const MethodRequest& request : requests)
    options_of(request);
  return requests;
}

}  // namespace fringe::cli
