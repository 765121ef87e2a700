#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "fringe/correction.hpp"
#include "fringe/error.hpp"

namespace fringe {
namespace {

constexpr std::array registry{
    CorrectionInfo{Correction::none, "none", "ε∫dA/d", "thesis 5.3", "", "one integral per triangle"},
    CorrectionInfo{
        Correction::formula, "formula",
        "coupling of the bodies' own charges, polarised, and the flux between surfaces that face; "
        "changes of readings in company: Galerkin projection of boundary elements on a few hundred "
        "functions, the machine at rest",
        "model/CORRECTIONS.md", "eight: fourth powers of the logarithm, set-ups not sealed; in company none",
        "one polygon and two integrals per facing triangle, 36 × 36 distances; in company the "
        "distances of some thousand points and two products with matrices"},
    CorrectionInfo{
        Correction::recommended, "recommended",
        "the Maxwell matrix by reduced boundary elements; formula where it states an error above 10 %, and "
        "for meshes of fewer than 96 or more than 2,500 triangles, or several",
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
  throw InputError(fmt::format(
      "correction '{}' is not known: it must be none, formula or recommended; model/CORRECTIONS.md tells of "
      "those that failed",
      text));
}

std::string to_string(Correction correction) {
  const auto* const found =
      std::ranges::find(registry, correction, [](const CorrectionInfo& info) { return info.correction; });
  return std::string(found->name);
}

}  // namespace fringe
