#include "measured.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace fringe::cli {

int decimals(double error) {
  constexpr int most = 9;
  if (error == 0)
    return most;
  // The exponent after rounding to two digits: 0.0996 is 0.10.
  const std::string rounded = fmt::format("{:.1e}", error);
  const int exponent = std::stoi(rounded.substr(rounded.find('e') + 1));
  return std::clamp(1 - exponent, 0, most);
}

std::string measured(double value, double error) {
  constexpr double large = 100;
  if (std::isinf(value) && error == 0)
    return unmeasured(value);
  if (!std::isfinite(error) || !std::isfinite(value))
    return "unknown";
  if (error >= large && error > std::abs(value))
    return fmt::format("unknown ± {:.2g}", error);
  if (error == 0)
    return fmt::format("{:.6g} ± 0", value);
  const int places = decimals(error);
  // An exponent shortens a small number, which would begin with many zeros.
  constexpr double small = 1e-2;
  constexpr int many = 7;
  if (places > many && std::abs(value) < small && value != 0) {
    constexpr double most_digits = 7;
    const double digits = std::floor(std::log10(std::abs(value))) - std::floor(std::log10(error)) + 1;
    return fmt::format("{:.{}e} ± {:.1e}", value, static_cast<int>(std::clamp(digits, 0.0, most_digits)),
                       error);
  }
  // The smallest that so many decimals show with two digits.
  constexpr double least = 1e-8;
  return error < least ? fmt::format("{:.{}f} ± {:.1e}", value, places, error)
                       : fmt::format("{:.{}f} ± {:.{}f}", value, places, error, places);
}

std::string unmeasured(double value) {
  return fmt::format("{:.6g}", value);
}

}  // namespace fringe::cli
