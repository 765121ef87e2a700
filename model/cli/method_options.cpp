#include "method_options.hpp"

#include <CLI/CLI.hpp>

namespace fringe::cli {

void add_method_options(CLI::App& command, MethodRequest& request) {
  command
      .add_option("--method", request.method,
                  "exact, split:N or gauss:K; or boundary-elements, for every shape, or reduced:K, the same "
                  "in microseconds for moving scenes; or recommended, the first of reduced:K, "
                  "boundary-elements and the correction formula that states the error asked for")
      ->capture_default_str();
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
      "0.001), reduced:1, 2, 3 (0.01, 0.001, 0.0003) and recommended (0.01)");
}

EvaluationOptions options_of(const MethodRequest& request) {
  EvaluationOptions options{.method = parse_method(request.method)};
  if (request.plates)
    options.plates = parse_plate_rule(*request.plates);
  if (request.faces)
    options.faces = parse_face_rule(*request.faces);
  if (request.correction)
    options.correction = parse_correction(*request.correction);
  options.tolerance = request.tolerance;
  options.rtol = request.rtol;
  validate(options);
  return options;
}

}  // namespace fringe::cli
