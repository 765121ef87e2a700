#include "reading_table.hpp"

#include <algorithm>

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
    return fmt::format("{:.6f}", value);
  return measured(value, *estimate.error * picofarads_per_farad);
}

/// Appends blanks up to a width; "±" is one character of two bytes.
std::string padded(const std::string& text, std::size_t width) {
  const std::size_t length = text.find("±") == std::string::npos ? text.size() : text.size() - 1;
  return text + std::string(width - std::min(width, length), ' ');
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
  return text;
}

}  // namespace fringe::cli
