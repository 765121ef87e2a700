#pragma once

namespace fringe::cli {

/// Tables are read by people: capacitances in pF.
inline constexpr double picofarads_per_farad = 1e12;

}  // namespace fringe::cli
