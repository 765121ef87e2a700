#include "fringe/method.hpp"

#include <array>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe {
namespace {

/// Parses the integer after "name:". Returns nothing when the text has another form or the number is outside
/// [least, most].
std::optional<int> parameter(std::string_view text, std::string_view name, int least, int most) {
  if (!text.starts_with(name))
    return std::nullopt;
  text.remove_prefix(name.size());
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < least || value > most)
    return std::nullopt;
  return value;
}

}  // namespace

bool is_integral(const Method& method) {
  return std::holds_alternative<Exact>(method) || std::holds_alternative<Split>(method) ||
         std::holds_alternative<Gauss>(method);
}

bool states_errors(const Method& method) {
  return !is_integral(method) && !std::holds_alternative<Formula>(method);
}

Method parse_method(std::string_view text) {
  if (text == "exact")
    return Exact{};
  if (const auto levels = parameter(text, "split:", 0, most_split_levels))
    return Split{*levels};
  if (const auto points = parameter(text, "gauss:", 1, most_gauss_points))
    return Gauss{*points};
  for (const Method& method :
       {Method(Formula{}), Method(Reduced{}), Method(BoundaryElements{}), Method(Auto{})})
    if (text == to_string(method))
      return method;
  if (text == "recommended")
    throw InputError("method 'recommended' is now called auto: write auto");
  if (text.starts_with("reduced:"))
    throw InputError(
        fmt::format("method '{}' is now called reduced, and follows the accuracy asked for: write "
                    "reduced with rtol",
                    text));
  throw InputError(fmt::format("method '{}' is not known: it must be exact, split:N (N from 0 to {}), "
                               "gauss:K (K from 1 to {}), formula, "
                               "reduced, boundary-elements or auto",
                               text, most_split_levels, most_gauss_points));
}

std::string to_string(const Method& method) {
  if (const auto* split = std::get_if<Split>(&method))
    return fmt::format("split:{}", split->levels);
  if (const auto* gauss = std::get_if<Gauss>(&method))
    return fmt::format("gauss:{}", gauss->points);
  /// In the order of the variant.
  constexpr std::array names{"exact", "split", "gauss", "formula", "reduced", "boundary-elements", "auto"};
  return names[method.index()];
}

}  // namespace fringe
