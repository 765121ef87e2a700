#include "export/matrix_csv.hpp"

#include <fmt/format.h>

#include "export/circuit.hpp"

namespace fringe::cli {
namespace {

/// Writes a name as a field, in quotation marks where a comma, a quotation mark or a line end needs them.
std::string field(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos)
    return name;
  std::string text = "\"";
  for (const char letter : name)
    text += letter == '"' ? "\"\"" : std::string(1, letter);
  return text + '"';
}

}  // namespace

std::string matrix_csv(const MaxwellMatrix& matrix) {
  require_finite(matrix);
  std::string text = "row,column,value_F,error_F\n";
  for (Eigen::Index i = 0; i < matrix.values.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.values.cols(); ++j)
      text += fmt::format("{},{},{},{}\n", field(matrix.conductors[static_cast<std::size_t>(i)]),
                          field(matrix.conductors[static_cast<std::size_t>(j)]), matrix.values(i, j) + 0.0,
                          matrix.errors(i, j));
  return text;
}

}  // namespace fringe::cli
