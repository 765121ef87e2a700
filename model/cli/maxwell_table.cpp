#include "maxwell_table.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "measured.hpp"
#include "units.hpp"

namespace fringe::cli {
namespace {

/// Width of an entry, as `entry` writes it.
constexpr std::size_t entry_width = 26;

/// Formats a value with its error (F) in `entry_width` columns.
std::string entry(double value, double error) {
  return fmt::format("{:>{}}", measured(value * picofarads_per_farad, error * picofarads_per_farad),
                     entry_width);
}

/// Returns the width of the columns: no name runs into the next one.
std::size_t column_width(const std::vector<std::string>& names, std::size_t least) {
  constexpr std::size_t between = 2;
  std::size_t width = least;
  for (const std::string& name : names)
    width = std::max(width, name.size() + between);
  return width;
}

}  // namespace

std::string maxwell_table(const Evaluation& answer, const EvaluationOptions& options, double seconds) {
  const MaxwellMatrix& matrix = answer.matrix.value();
  const std::size_t width = column_width(matrix.conductors, entry_width);
  const std::size_t names_width = column_width(matrix.conductors, 12);
  std::string text =
      fmt::format("Maxwell matrix by {}, pF: charge on the row's conductor per volt on the column's\n"
                  "rtol {} {}{}, {} unknowns, {:.3g} s\n\n{:<{}}",
                  answer.answered_by, rtol_of(options), answer.reached ? "reached" : "NOT reached",
                  options.entries == Entries::of_readings ? " in the readings" : "", matrix.unknowns, seconds,
                  "", names_width);
  for (const std::string& name : matrix.conductors)
    text += fmt::format("{:>{}}", name, width);
  text += '\n';
  for (Eigen::Index i = 0; i < matrix.values.rows(); ++i) {
    text += fmt::format("{:<{}}", matrix.conductors[static_cast<std::size_t>(i)], names_width);
    for (Eigen::Index j = 0; j < matrix.values.cols(); ++j)
      text += std::string(width - entry_width, ' ') + entry(matrix.values(i, j), matrix.errors(i, j));
    text += '\n';
  }
  text += "\ndelta_self, pF: the sensor's own entry less what it is without the objects\n";
  for (Eigen::Index s = 0; s < matrix.delta_self.size(); ++s)
    text += fmt::format("{:<{}}{}\n", matrix.conductors[static_cast<std::size_t>(s)], names_width,
                        entry(matrix.delta_self[s], matrix.delta_self_errors[s]));
  text += "The errors are estimates.";
  const bool any_bound =
      std::find(matrix.lower_bounds.begin(), matrix.lower_bounds.end(), true) != matrix.lower_bounds.end();
  for (std::size_t k = 0; k < matrix.conductors.size(); ++k)
    if (any_bound && !matrix.lower_bounds[k])
      text += fmt::format(" The diagonal entry of {} may be above the truth.", matrix.conductors[k]);
  text += any_bound ? " Entries of the diagonal are otherwise not above the truth.\n" : "\n";
  for (const std::string& name : matrix.floating)
    text += fmt::format("floating, without charge and so without a row: {}\n", name);
  return text;
}

}  // namespace fringe::cli
