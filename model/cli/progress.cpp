#include "progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace fringe::cli {
namespace {

/// Returns to the first column and erases the line (ECMA-48).
constexpr const char* erased = "\r\x1b[K";

}  // namespace

std::optional<double> remaining_seconds(const std::vector<TimedLevel>& levels, double rtol) {
  /// Gain below which the number of further solutions is anybody's guess.
  constexpr double least_gain = 1.1;
  if (levels.size() < 2)
    return std::nullopt;
  const TimedLevel &last = levels.back(), &previous = levels[levels.size() - 2];
  const double gain = previous.error / last.error;
  if (!(gain >= least_gain))
    return std::nullopt;
  const double begin = levels.size() > 2 ? levels[levels.size() - 3].seconds : 0;
  const double took = last.seconds - previous.seconds, took_before = previous.seconds - begin;
  const double growth = took_before > 0 ? std::max(took / took_before, 1.0) : 1;
  const int solutions =
      std::max(static_cast<int>(std::ceil(std::log(last.error / rtol) / std::log(gain))), 1);
  double seconds = 0;
  for (int k = 1; k <= solutions; ++k)
    seconds += took * std::pow(growth, k);
  return seconds;
}

ProgressLine::ProgressLine(double rtol)
    : rtol_(rtol), is_on_terminal_(isatty(STDERR_FILENO) == 1), start_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() {
  if (has_shown_)
    std::fputs(erased, stderr);
}

void ProgressLine::show(const std::string& text, const std::string& to_go) {
  if (!is_on_terminal_)
    return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  fmt::print(stderr, "{}{}, {:.1f} s{}", erased, text, elapsed.count(), to_go);
  std::fflush(stderr);
  has_shown_ = true;
}

void ProgressLine::show(const RefinementLevel& level) {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  levels_.push_back({level.error, elapsed.count()});
  const std::optional<double> remaining = remaining_seconds(levels_, rtol_);
  show(fmt::format("{} unknowns, error {:.2g} of {:g} asked for", level.unknowns, level.error, rtol_),
       remaining ? fmt::format(", about {:.0f} s to go", std::ceil(*remaining)) : std::string());
}

}  // namespace fringe::cli
