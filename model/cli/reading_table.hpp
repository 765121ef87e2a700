#pragma once

#include <string>
#include <vector>

#include "fringe/reading_answer.hpp"

namespace fringe::cli {

/// Formats readings as a table for people, in pF. What a method does not know is a dash.
std::string reading_table(const std::vector<ReadingAnswer>& readings);

}  // namespace fringe::cli
