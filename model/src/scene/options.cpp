#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/reduced_capacitance.hpp"

/// Which options go with which method: here and nowhere else.

namespace fringe {
namespace {

/// Refuses a folder of prepared data where nothing would be kept in it.
void check_prepared(const EvaluationOptions& options) {
  if (options.prepared && !(options.rtol && (options.correction == Correction::formula ||
                                             std::holds_alternative<Recommended>(options.method))))
    throw InputError("prepared is an option of the correction formula with an rtol, and of recommended with "
                     "one: others prepare nothing that is kept");
}

/// Checks a limit of time, which methods that answer at once do not have.
void check_max_seconds(const EvaluationOptions& options) {
  if (!options.max_seconds)
    return;
  if (!(std::isfinite(*options.max_seconds) && *options.max_seconds > 0))
    throw InputError(fmt::format("max_seconds {} must be finite and positive", *options.max_seconds));
  if (is_integral(options.method) && !options.rtol)
    throw InputError(
        fmt::format("max_seconds is no option of {}, which answers at once", to_string(options.method)));
}

[[noreturn]] void refuse_derivatives(const std::string& answering) {
  throw InputError(fmt::format("derivatives are known by exact without a correction, boundary-elements, "
                               "reduced:K and the correction formula with an rtol, not by {}",
                               answering));
}

}  // namespace

PlateRule parse_plate_rule(std::string_view text) {
  if (text == "sum")
    return PlateRule::sum;
  if (text == "nearest")
    return PlateRule::nearest;
  throw InputError(fmt::format("plates '{}' is not known: it must be sum or nearest", text));
}

FaceRule parse_face_rule(std::string_view text) {
  if (text == "all")
    return FaceRule::all;
  if (text == "facing")
    return FaceRule::facing;
  throw InputError(fmt::format("faces '{}' is not known: it must be all or facing", text));
}

std::string to_string(PlateRule rule) {
  return rule == PlateRule::sum ? "sum" : "nearest";
}

FaceRule rule_for(const Shape& shape, FaceRule rule) {
  const bool is_sheet = std::holds_alternative<Plate>(shape) || std::holds_alternative<Disc>(shape) ||
                        std::holds_alternative<Polygon>(shape);
  return is_sheet ? FaceRule::all : rule;
}

std::string to_string(FaceRule rule) {
  return rule == FaceRule::all ? "all" : "facing";
}

void validate(const CapacitanceOptions& options) {
  if (!is_integral(options.method))
    throw InputError(fmt::format("{} is not a triangle-integral method", to_string(options.method)));
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    throw InputError(fmt::format("tolerance {} must be finite and not negative", options.tolerance));
  if (options.tolerance > 0 && !std::holds_alternative<Exact>(options.method))
    throw InputError(fmt::format("a tolerance needs the method exact: {} does not know its own error",
                                 to_string(options.method)));
  if (options.correction == Correction::none)
    return;
  // Each correction determines itself which faces count and how they are integrated.
  if (!std::holds_alternative<Exact>(options.method) || options.plates != PlateRule::sum ||
      options.faces != FaceRule::all || options.tolerance > 0)
    throw InputError(fmt::format("correction {}: method, plates, faces and tolerance must be their defaults",
                                 to_string(options.correction)));
}

void validate(const EvaluationOptions& options) {
  if (is_integral(options.method))
    integral_options(options);
  else
    rtol_of(options);
}

CapacitanceOptions integral_options(const EvaluationOptions& options) {
  check_prepared(options);
  check_max_seconds(options);
  if (options.rtol) {
    if (options.correction != Correction::formula)
      throw InputError(
          "rtol is an option of the methods boundary-elements, reduced:K and recommended, and of the "
          "correction formula");
    validate(BoundaryElementOptions{.rtol = *options.rtol});
  }
  const CapacitanceOptions defaults;
  const CapacitanceOptions asked{
      options.method, options.plates.value_or(defaults.plates), options.faces.value_or(defaults.faces),
      options.tolerance.value_or(defaults.tolerance), options.correction.value_or(defaults.correction)};
  validate(asked);
  if (options.derivatives && options.rtol)
    return asked;
  if (options.derivatives && asked.correction != Correction::none)
    refuse_derivatives("the correction " + to_string(asked.correction));
  if (options.derivatives && !std::holds_alternative<Exact>(asked.method))
    refuse_derivatives(to_string(asked.method));
  return asked;
}

double rtol_of(const EvaluationOptions& options) {
  check_prepared(options);
  check_max_seconds(options);
  if (is_integral(options.method) && options.rtol) {
    validate(options);
    return *options.rtol;
  }
  const auto refuse = [&](bool is_given, std::string_view option) {
    if (is_given)
      throw InputError(fmt::format("{} is an option of the triangle-integral methods, not of {}", option,
                                   to_string(options.method)));
  };
  refuse(options.plates.has_value(), "plates");
  refuse(options.faces.has_value(), "faces");
  refuse(options.tolerance.has_value(), "tolerance");
  refuse(options.correction.has_value(), "correction");
  if (options.derivatives && std::holds_alternative<Recommended>(options.method))
    refuse_derivatives(to_string(options.method));
  if (const auto* reduced = std::get_if<Reduced>(&options.method))
    return rtol_of(ReducedOptions{reduced->steps, options.rtol});
  /// Default error of the method `recommended`, relative.
  constexpr double recommended_rtol = 1e-2;
  const double usual =
      std::holds_alternative<Recommended>(options.method) ? recommended_rtol : BoundaryElementOptions{}.rtol;
  const double rtol = options.rtol.value_or(usual);
  validate(BoundaryElementOptions{.rtol = rtol});
  return rtol;
}

}  // namespace fringe
