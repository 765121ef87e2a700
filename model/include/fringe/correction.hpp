#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe {

/// What takes the place of ε∫dA/d for an object before a sensor (model/CORRECTIONS.md).
enum class Correction {
  none,
  constant,
  arc,
  kirchhoff,
  palmer,
  reciprocity,
  two_sided_arc,
  formula,
  recommended,
};

/// What is known of a correction.
struct CorrectionInfo {
  Correction correction;
  std::string_view name;
  std::string_view formula;
  std::string_view source;
  std::string_view constants;  ///< and how they were fitted; empty where there are none
  std::string_view cost;
};

/// All corrections, the plain model first.
std::span<const CorrectionInfo> corrections();

/// Reads a name of the registry. Throws InputError, which names the choices, for anything else.
Correction parse_correction(std::string_view text);

std::string to_string(Correction correction);

/// What the correction `formula` is combined from for one sensor and one object (model/CORRECTIONS.md); in m
/// where nothing else is said.
struct FormulaTerms {
  /// How the potential of the other body's own charge varies over a body: variances relative to the mean
  /// squared.
  struct Variation {
    double linear = 0;
    double quadratic = 0;
    double remaining = 0;
  };
  double own_of_sensor = 0;  ///< C/ε of the sensor alone
  double own_of_object = 0;
  double potential = 0;  ///< 1/m: mean potential of one body's own charge on the other, per charge over ε
  Variation on_sensor;
  Variation on_object;
  double drawn = 0;          ///< how both charges draw each other, without a unit
  double flux = 0;           ///< ∫dA/L between sides that face each other; +infinity on contact
  double soft_flux = 0;      ///< the same with softened gaps
  double tilted_excess = 0;  ///< their difference weighted by 1 − cos θ
  double facing_area = 0;    ///< m²
};

/// The terms of every sensor (first index) and object of a scene, for those who fit the constants. Throws
/// InputError for what capacitance() refuses.
std::vector<std::vector<FormulaTerms>> formula_terms(const Scene& scene);

}  // namespace fringe
