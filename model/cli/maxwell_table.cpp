#include "maxwell_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "units.hpp"

namespace fringe::cli {
std::string maxwell_table(const MaxwellMatrix& matrix, const answers::MaxwellRequest& request,
                          double seconds) {
  std::string text = fmt::format(
      "Maxwell matrix by boundary elements{}, pF: charge on the row's conductor per volt on the column's\n"
      "rtol {} {}, {} unknowns, {:.3g} s\n\n{:<12}",
      request.method == "boundary-elements" ? "" : fmt::format(" ({})", request.method), request.rtol,
      matrix.reached ? "reached" : "NOT reached", matrix.unknowns, seconds, "");
  for (const std::string& name : matrix.conductors)
    text += fmt::format("{:>24}", name);
  text += '\n';
  for (Eigen::Index i = 0; i < matrix.values.rows(); ++i) {
    text += fmt::format("{:<12}", matrix.conductors[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < matrix.values.cols(); ++j)
      text += fmt::format("{:>12.6f} ± {:<9.6f}", matrix.values(i, j) * picofarads_per_farad,
                          matrix.errors(i, j) * picofarads_per_farad);
    text += '\n';
  }
  text += "\ndelta_self, pF: the sensor's own entry less what it is without the objects\n";
  for (Eigen::Index s = 0; s < matrix.delta_self.size(); ++s)
    text += fmt::format("{:<12}{:>12.6f} ± {:<9.6f}\n", matrix.conductors[static_cast<std::size_t>(s)],
                        matrix.delta_self[s] * picofarads_per_farad,
                        matrix.delta_self_errors[s] * picofarads_per_farad);
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
