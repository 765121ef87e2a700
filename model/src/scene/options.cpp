#include "scene/options.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fringe/error.hpp"

/// Which options go with which method: here and nowhere else.

namespace fringe {
namespace {

/// Relative error asked for where none is given: the same for every method.
constexpr double usual_rtol = 1e-2;

/// What a method's name may end with.
constexpr std::string_view nearest_suffix = "+nearest", facing_suffix = "+facing";

template <typename... Methods>
bool is_one_of(const Method& method) {
  return (std::holds_alternative<Methods>(method) || ...);
}

/// Refuses an option that a method does not have, if it is given.
void refuse(bool is_given, std::string_view option, const Method& method, std::string_view reason) {
  if (is_given)
    throw InputError(fmt::format("{} is no option of {}{}", option, to_string(method), reason));
}

/// Throws InputError for options of a triangle-integral method or the formula that are out of range or cannot
/// be combined.
void validate_integral(const EvaluationOptions& options) {
  const Method method = method_of(options);
  const bool is_formula = std::holds_alternative<Formula>(method);
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    throw InputError(fmt::format("tolerance {} must be finite and not negative", options.tolerance));
  if (options.tolerance > 0 && !std::holds_alternative<Exact>(method))
    throw InputError(
        fmt::format("a tolerance needs the method exact: {} does not know its own error", to_string(method)));
  // The formula determines itself which faces count and how they are integrated.
  if (is_formula && (options.plates != PlateRule::sum || options.faces != FaceRule::all))
    throw InputError("+nearest and +facing belong to exact, split:N and gauss:K, not to formula");
}

}  // namespace

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

Method method_of(const EvaluationOptions& options) {
  return options.method.value_or(options.rtol ? Method(Auto{}) : Method(Exact{}));
}

EvaluationOptions with_method(EvaluationOptions options, std::string_view text) {
  const auto ends_with = [&](std::string_view suffix) {
    const bool found = text.ends_with(suffix);
    if (found)
      text.remove_suffix(suffix.size());
    return found;
  };
  options.faces = FaceRule::all;
  options.plates = PlateRule::sum;
  // In either order.
  for (bool found = true; found;) {
    const bool is_facing = ends_with(facing_suffix), is_nearest = ends_with(nearest_suffix);
    options.faces = is_facing ? FaceRule::facing : options.faces;
    options.plates = is_nearest ? PlateRule::nearest : options.plates;
    found = is_facing || is_nearest;
  }
  options.method = parse_method(text);
  return options;
}

std::string method_text(const EvaluationOptions& options) {
  return fmt::format("{}{}{}", to_string(method_of(options)),
                     options.plates == PlateRule::nearest ? nearest_suffix : "",
                     options.faces == FaceRule::facing ? facing_suffix : "");
}

void validate(const EvaluationOptions& options) {
  const Method method = method_of(options);
  const bool is_matrix = states_errors(method), integrates = !is_matrix;
  if (options.rtol)
    validate(BoundaryElementOptions{.rtol = *options.rtol});
  refuse(integrates && options.rtol, "rtol", method, ", which states no error: auto reaches an accuracy");
  refuse(!is_matrix && options.entries != Entries::of_readings, "entries", method,
         ", which knows no Maxwell matrix");
  if (options.max_seconds && !(std::isfinite(*options.max_seconds) && *options.max_seconds > 0))
    throw InputError(fmt::format("max_seconds {} must be finite and positive", *options.max_seconds));
  refuse(integrates && options.max_seconds, "max_seconds", method, ", which answers at once");
  refuse(!is_one_of<Reduced, Auto>(method) && options.prepared, "prepared", method,
         ", which prepares nothing that is kept: reduced and auto do");
  refuse(!is_one_of<Exact, Reduced, BoundaryElements, Auto>(method) && options.derivatives, "derivatives",
         method, ": exact, reduced, boundary-elements and auto know them");
  refuse(is_matrix && options.tolerance != 0, "tolerance", method, ": it belongs to exact");
  if (is_matrix && (options.plates != PlateRule::sum || options.faces != FaceRule::all))
    throw InputError(fmt::format("{} and {} belong to exact, split:N and gauss:K, not to {}", nearest_suffix,
                                 facing_suffix, to_string(method)));
  if (!is_matrix)
    validate_integral(options);
}

detail::IntegralOptions detail::integral_options(const EvaluationOptions& options) {
  validate(options);
  const Method method = method_of(options);
  if (states_errors(method))
    throw InputError(fmt::format("{} is not a triangle-integral method", to_string(method)));
  return {method, options.plates, options.faces, options.tolerance};
}

double rtol_of(const EvaluationOptions& options) {
  return options.rtol.value_or(usual_rtol);
}

}  // namespace fringe
