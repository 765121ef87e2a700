#pragma once

#include <string>

namespace fringe::cli {

/// Picofarads in one farad; tables give capacitances in pF.
inline constexpr double picofarads_per_farad = 1e12;
/// Femtofarads in one farad, for the changes of readings and their noise.
inline constexpr double femtofarads_per_farad = 1e15;

/// Returns the number of decimals that an error leaves: two of its digits. Zero for errors of ten and more,
/// at most 9.
int decimals(double error);

/// Writes a value with its error, both to two digits of the error, as in "2.4914 ± 0.0011". Of a value that
/// is smaller than an error of a hundred or more, no digit is known: "unknown ± 2.7e+14". An error that is
/// not a number, or infinite, makes the value unknown too. The infinite value of contact is certain: "inf".
std::string measured(double value, double error);

/// Writes a value whose error is not known, to six digits.
std::string unmeasured(double value);

}  // namespace fringe::cli
