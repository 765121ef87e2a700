#pragma once

#include <limits>

namespace fringe::detail {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace fringe::detail
