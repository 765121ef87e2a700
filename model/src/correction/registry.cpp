#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "fringe/correction.hpp"
#include "fringe/error.hpp"

namespace fringe {
namespace {

constexpr std::array registry{
    CorrectionInfo{Correction::none, "none", "ε∫dA/d", "thesis 5.3", "", "one integral per triangle"},
    CorrectionInfo{Correction::constant, "constant", "c·ε∫dA/d", "one number for all that is missing",
                   "c: mean logarithm of truth over model", "one integral per triangle"},
    CorrectionInfo{Correction::arc, "arc", "ε Σ (sin θ/θ)∫dA/d, θ between triangle and plate",
                   "field between the plates of a wedge", "", "one integral per triangle"},
    CorrectionInfo{Correction::kirchhoff, "kirchhoff",
                   "ε Σ I·[1 + (δ/πa)·(ln(16πa/δ) − 1)], I = ∫dA/d, δ = A/I, πa² the plate's area",
                   "G. Kirchhoff, Monatsber. Akad. Wiss. Berlin 1877, 144", "",
                   "one integral and one logarithm per triangle"},
    CorrectionInfo{
        Correction::palmer, "palmer", "ε Σ I·Π [1 + (δ/πL)·(1 + ln(2πL/δ))] over the plate's two lengths L",
        "H. B. Palmer, Trans. AIEE 56 (1937) 363", "", "one integral and two logarithms per triangle"},
    CorrectionInfo{Correction::reciprocity, "reciprocity",
                   "ε√(∫dA/d over the object · ∫dA/d over the sensor)", "Green: the true matrix is symmetric",
                   "", "adaptive quadrature on both surfaces"},
    CorrectionInfo{Correction::two_sided_arc, "two-sided-arc",
                   "ε√(A B), A and B each ∫dA·(1/L_front + 1/L_back) over one surface",
                   "model/CORRECTIONS.md: field lines as arcs, also around edges",
                   "k: least squares of the logarithm", "adaptive quadrature on both surfaces"},
    CorrectionInfo{Correction::formula, "formula",
                   "coupling of the bodies' own charges, polarised, and the flux between surfaces that face",
                   "model/CORRECTIONS.md", "eight: fourth powers of the logarithm, set-ups not sealed",
                   "one polygon and two integrals per facing triangle, 36 × 36 distances"},
    CorrectionInfo{
        Correction::recommended, "recommended",
        "the Maxwell matrix by reduced boundary elements; formula where it states an error above 10 %, and "
        "for meshes of fewer than 96 or more than 2,000 triangles, or several",
        "model/BOUNDARY_ELEMENTS.md, section 8", "",
        "some microseconds for plates and boxes, all bodies together, ten integrals for a mesh; else that of "
        "formula"},
};

}  // namespace

std::span<const CorrectionInfo> corrections() {
  return registry;
}

Correction parse_correction(std::string_view text) {
  for (const CorrectionInfo& info : registry)
    if (info.name == text)
      return info.correction;
  std::string names;
  for (const CorrectionInfo& info : registry)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", info.name);
  throw InputError(fmt::format("correction '{}' is not known: it must be one of {}", text, names));
}

std::string to_string(Correction correction) {
  const auto* const found =
      std::ranges::find(registry, correction, [](const CorrectionInfo& info) { return info.correction; });
  return std::string(found->name);
}

}  // namespace fringe
