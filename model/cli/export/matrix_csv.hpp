#pragma once

#include <string>

#include "fringe/boundary_elements.hpp"

namespace fringe::cli {

/// Writes a Maxwell matrix as comma-separated values: a line for each entry with the names of its row and
/// column, the value and the stated error in F. Throws InputError for an entry that is not finite.
std::string matrix_csv(const MaxwellMatrix& matrix);

}  // namespace fringe::cli
