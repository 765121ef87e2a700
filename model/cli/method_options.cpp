#include "method_options.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::cli {
namespace {

/// An option of before, and what to write now.
struct Former {
  std::string_view option;
  std::string_view now;
};

constexpr std::array former_options{
    Former{"--correction", "write --method formula, or --method auto for what was recommended"},
    Former{"--plates", "write +nearest after the method, as in --method exact+nearest"},
    Former{"--faces", "write +facing after the method, as in --method exact+facing"},
    Former{"--only-readings", "leave it out, as --rtol is for readings now and --entries asks for more"},
};

/// Tells whether a method has an option: whether it is accepted by itself.
template <typename Option>
bool has(const MethodRequest& method, Option MethodRequest::*option, const Option& value) {
  MethodRequest alone{.method = method.method};
  alone.*option = value;
  try {
    options_of(alone);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

void add_method_options(CLI::App& command, MethodRequest& request) {
  command
      .add_option(
          "--method", request.method,
          "exact, split:N or gauss:K: the model, each with +nearest (only the nearest plate of a sensor "
          "counts a point) and +facing (only faces that see the plate count) after it; formula, in "
          "closed form; reduced, prepared once, then in micro- to milliseconds; boundary-elements; auto, "
          "the cheaper of these two that states the accuracy")
      ->default_str("auto with --rtol, else exact");
  add_accuracy_options(command, request);
  command.add_flag("--entries", request.entries,
                   "Reach the accuracy in each entry of the Maxwell matrix in the rows of sensors and "
                   "electrodes, too, and so in what each object adds");
  command.add_option("--tolerance", request.tolerance,
                     "What may be left out of a sensor's total, relative to it; only with exact");
  command.add_flag(
      "--derivatives", request.derivatives,
      "Also the derivatives of the readings' changes with respect to the pose of every link; not "
      "with formula, split:N and gauss:K");
}

void add_accuracy_options(CLI::App& command, MethodRequest& request) {
  command.add_option("--rtol", request.rtol,
                     "The relative error to be reached in value and change of every reading (if not given, "
                     "0.01); not with the model, which states no error");
  command
      .add_option(
          "--max-seconds", request.max_seconds,
          "End after this time with the best answer so far, as Ctrl-C does; not with the model, which "
          "answers at once")
      ->type_name("SECONDS");
  command
      .add_option(
          "--prepared", request.prepared,
          "Keep what takes long to prepare in this folder, and take from it what is there of the same "
          "scene; with reduced and auto")
      ->type_name("FOLDER");
}

void refuse_former_options(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments)
    for (const auto& [option, now] : former_options)
      if (argument == option || argument.starts_with(std::string(option) + "="))
        throw InputError(fmt::format("{} is gone: {}", option, now));
}

EvaluationOptions options_of(const MethodRequest& request) {
  EvaluationOptions options;
  if (request.method)
    options = with_method(std::move(options), *request.method);
  options.tolerance = request.tolerance.value_or(options.tolerance);
  options.rtol = request.rtol;
  options.max_seconds = request.max_seconds;
  options.entries = request.entries ? Entries::of_sensors : Entries::of_readings;
  options.derivatives = request.derivatives;
  if (request.prepared)
    options.prepared = *request.prepared;
  validate(options);
  return options;
}

std::vector<MethodRequest> requests_of(const std::vector<std::string>& methods,
                                       const MethodRequest& options) {
  std::vector<MethodRequest> requests;
  for (const std::string& method : methods) {
    requests.push_back(options);
    requests.back().method = method;
  }
  // An option that no method has stays, so that it is refused.
  const auto leave_to = [&](const auto option) {
    if (!(options.*option))
      return;
    const auto has_it = [&](const MethodRequest& request) { return has(request, option, options.*option); };
    if (std::ranges::any_of(requests, has_it))
      for (MethodRequest& request : requests)
        if (!has_it(request))
          (request.*option).reset();
  };
  leave_to(&MethodRequest::rtol);
  leave_to(&MethodRequest::prepared);
  leave_to(&MethodRequest::max_seconds);
  for (const MethodRequest& request : requests)
    options_of(request);
  return requests;
}

}  // namespace fringe::cli
