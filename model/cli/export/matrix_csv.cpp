#include "export/matrix_csv.hpp"

#include <fmt/format.h>

#include "csv_text.hpp"
#include "export/circuit.hpp"

namespace fringe::cli {
std::string matrix_csv(const MaxwellMatrix& matrix) {
  require_finite(matrix);
  std::string text = "row,column,value_F,error_F\n";
  for (Eigen::Index i = 0; i < matrix.values.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.values.cols(); ++j)
      text += fmt::format("{},{},{},{}\n", csv_field(matrix.conductors[static_cast<std::size_t>(i)]),
                          csv_field(matrix.conductors[static_cast<std::size_t>(j)]),
                          matrix.values(i, j) + 0.0, matrix.errors(i, j));
  return text;
}

}  // namespace fringe::cli
