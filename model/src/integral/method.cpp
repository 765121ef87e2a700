#include "fringe/method.hpp"

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

Method parse_method(std::string_view text) {
  if (text == "exact")
    return Exact{};
  if (const auto levels = parameter(text, "split:", 0, most_split_levels))
    return Split{*levels};
  if (const auto points = parameter(text, "gauss:", 1, most_gauss_points))
    return Gauss{*points};
  if (text == "boundary-elements")
    return BoundaryElements{};
  if (const auto steps = parameter(text, "reduced:", 1, most_reduced_steps))
    return Reduced{*steps};
  if (text == "recommended")
    return Recommended{};
  throw InputError(fmt::format(
      "method '{}' is not known: it must be exact, split:N (N from 0 to {}), gauss:K (K from 1 to {}), "
      "boundary-elements, reduced:K (K from 1 to {}) or recommended",
      text, most_split_levels, most_gauss_points, most_reduced_steps));
}

std::string to_string(const Method& method) {
  if (const auto* split = std::get_if<Split>(&method))
    return fmt::format("split:{}", split->levels);
  if (const auto* gauss = std::get_if<Gauss>(&method))
    return fmt::format("gauss:{}", gauss->points);
  if (const auto* reduced = std::get_if<Reduced>(&method))
    return fmt::format("reduced:{}", reduced->steps);
  if (std::holds_alternative<BoundaryElements>(method))
    return "boundary-elements";
  return std::holds_alternative<Recommended>(method) ? "recommended" : "exact";
}

}  // namespace fringe
