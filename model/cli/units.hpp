#pragma once

namespace fringe::cli {

/// Picofarads in one farad; tables give capacitances in pF.
inline constexpr double picofarads_per_farad = 1e12;

}  // namespace fringe::cli
