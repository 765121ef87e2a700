#pragma once

namespace fringe::cli {

/// Picofarads in one farad; tables give capacitances in pF.
inline constexpr double picofarads_per_farad = 1e12;
/// Femtofarads in one farad, for the changes of readings and their noise.
inline constexpr double femtofarads_per_farad = 1e15;

}  // namespace fringe::cli
