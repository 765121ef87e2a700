#pragma once

#include <span>
#include <string>
#include <string_view>

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

/// Reads a name of the registry, or "recommended", the best there is. Throws InputError, which names the
/// choices, for anything else.
Correction parse_correction(std::string_view text);

std::string to_string(Correction correction);

}  // namespace fringe
