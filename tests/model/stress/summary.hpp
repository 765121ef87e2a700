#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assessment.hpp"

/// Summaries of the methods' errors, class by class.
namespace fringe::stress {

/// Relative errors, and their ratios to the conditioning, of the finite results whose truth is finite and
/// positive; absent when there are none.
struct MethodSummary {
  std::size_t triangles = 0;           ///< triangles to which the method applies
  std::size_t not_finite = 0;          ///< infinite or not a number where the truth is finite
  std::size_t wrong_by_1_percent = 0;  ///< off by more than 1 %, or wrongly 0, infinite or NaN
  std::optional<double> largest_error, median_error;
  std::optional<double> largest_over_conditioning, median_over_conditioning, percentile_99_over_conditioning;
};

struct ClassSummary {
  TriangleClass of_class;
  std::size_t triangles = 0;
  std::size_t truth_failed = 0;
  std::vector<std::pair<std::string, MethodSummary>> methods;
  /// Largest value of error_over_allowed, for each tolerance.
  std::array<double, tolerances.size()> largest_over_allowed{};
};

ClassSummary summarize(const Assessment& assessment);

/// One run of the program.
struct Summary {
  std::size_t count = 0;
  std::uint64_t seed = 0;
  double seconds = 0;
  std::vector<ClassSummary> classes;
};

/// Writes the summary as JSON to a temporary file, which is then renamed.
void write_json(const Summary& summary, const std::string& path);

}  // namespace fringe::stress
