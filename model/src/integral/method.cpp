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

Method parse_method(std::string_view text) {
  if (text == "exact")
    return Exact{};
  if (const auto levels = parameter(text, "split:", 0, most_split_levels))
    return Split{*levels};
  if (const auto points = parameter(text, "gauss:", 1, most_gauss_points))
    return Gauss{*points};
  throw InputError(fmt::format(
      "method '{}' is not known: it must be exact, split:N (N from 0 to {}) or gauss:K (K from 1 to {}); of "
      "a whole scene also boundary-elements or reduced:K",
      text, most_split_levels, most_gauss_points));
}

std::string to_string(const Method& method) {
  if (const auto* split = std::get_if<Split>(&method))
    return fmt::format("split:{}", split->levels);
  if (const auto* gauss = std::get_if<Gauss>(&method))
    return fmt::format("gauss:{}", gauss->points);
  return "exact";
}

}  // namespace fringe
