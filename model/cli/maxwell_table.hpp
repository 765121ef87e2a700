#pragma once

#include <string>

#include "answers/answers.hpp"

namespace fringe::cli {

/// Formats a Maxwell matrix as a table in pF.
std::string maxwell_table(const MaxwellMatrix& matrix, const answers::MaxwellRequest& request,
                          double seconds);

}  // namespace fringe::cli
