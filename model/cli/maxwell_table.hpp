#pragma once

#include <string>

#include "fringe/evaluation.hpp"

namespace fringe::cli {

/// Formats the Maxwell matrix of an evaluation that has one as a table in pF.
std::string maxwell_table(const Evaluation& answer, const EvaluationOptions& options, double seconds);

}  // namespace fringe::cli
