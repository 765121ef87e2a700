#include "reading_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "measured.hpp"
#include "units.hpp"

namespace fringe::cli {
namespace {

std::string text_of(const Estimate& estimate) {
  if (!estimate.value)
    return "-";
  const double value = *estimate.value * picofarads_per_farad;
  if (!estimate.error)
    return unmeasured(value);
  return measured(value, *estimate.error * picofarads_per_farad);
}

/// Appends blanks up to a width; "±" is one character of two bytes.
std::string padded(const std::string& text, std::size_t width) {
  const std::size_t length = text.find("±") == std::string::npos ? text.size() : text.size() - 1;
  return text + std::string(std::max(width, length + 1) - length, ' ');
}

/// Formats a derivative that is given in F/m or F/rad.
std::string text_of(double derivative, std::optional<double> error) {
  if (std::isnan(derivative))
    return "-";
  const double value = derivative * picofarads_per_farad;
  return error ? measured(value, *error * picofarads_per_farad) : unmeasured(value);
}

/// Formats the derivatives of the changes, a row for each reading and link; empty if there are none.
std::string derivative_table(const std::vector<ReadingAnswer>& readings, std::size_t names_width) {
  std::string rows;
  for (const ReadingAnswer& reading : readings)
    for (const LinkDerivatives& of_link : reading.derivatives) {
      rows += fmt::format("  {:<{}}{:<14}", reading.name, names_width, of_link.link);
      for (Eigen::Index k = 0; k < of_link.change.size(); ++k)
        rows += padded(
            text_of(of_link.change[k], of_link.error ? std::optional((*of_link.error)[k]) : std::nullopt),
            of_link.error ? 24 : 14);
      rows.erase(rows.find_last_not_of(' ') + 1);
      rows += '\n';
    }
  if (rows.empty())
    return {};
  return "\nDerivatives of the changes by the pose of each link: pF/m along x, y, z, pF/rad about x, y, z\n" +
         rows;
}

}  // namespace

std::string reading_table(const std::vector<ReadingAnswer>& readings) {
  constexpr std::size_t width = 26;
  if (readings.empty())
    return {};
  std::string text = "\nReadings, pF: value, background (without the targets) and change, their difference\n";
  std::size_t names_width = 12;
  for (const ReadingAnswer& reading : readings)
    names_width = std::max(names_width, reading.name.size() + 2);
  for (const ReadingAnswer& reading : readings)
    text += fmt::format("  {:<{}}{}{}{}\n", reading.name, names_width, padded(text_of(reading.value), width),
                        padded(text_of(reading.background), width), text_of(reading.change));
  return text + derivative_table(readings, names_width);
}

}  // namespace fringe::cli
