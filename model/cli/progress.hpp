#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "fringe/boundary_elements.hpp"

namespace fringe::cli {

/// The error of a solution, and the time at which it was known.
struct TimedLevel {
  double error;
  double seconds;
};

/// Estimates the seconds that refinement takes until an error is reached. Each further solution is expected
/// to gain as much as the last one, and to take longer than the one before by the same factor. Empty before
/// there are two solutions, and where the last one gained hardly anything.
std::optional<double> remaining_seconds(const std::vector<TimedLevel>& levels, double rtol);

/// Says how far boundary elements or preparations are, in a line on standard error that is written again
/// after each solution or step and erased at the end; nothing where that is no terminal.
class ProgressLine {
 public:
  explicit ProgressLine(double rtol);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const RefinementLevel& level);
  /// Shows what is being done, for how long, and how long it may still take.
  void show(const std::string& text, const std::string& to_go = "");

 private:
  double rtol_;
  bool is_on_terminal_;
  bool has_shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::vector<TimedLevel> levels_;
};

}  // namespace fringe::cli
