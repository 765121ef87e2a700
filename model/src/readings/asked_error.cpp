#include "readings/asked_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/infinity.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Entries of this part of the diagonal are as accurate as they are large. Those of bodies that others shield
/// from each other are far smaller, and no reading's change depends on their digits.
constexpr double least_part = 1e-3;

VectorXd errors_of_values(const std::vector<ReadingAnswer>& readings) {
  VectorXd errors(static_cast<Index>(readings.size()));
  for (std::size_t k = 0; k < readings.size(); ++k)
    errors[static_cast<Index>(k)] = readings[k].value.error.value_or(0);
  return errors;
}

}  // namespace

VectorXd value_scales(const MaxwellMatrix& answer, const ChargedBodies& bodies) {
  VectorXd scales = VectorXd::Constant(static_cast<Index>(bodies.readings.size()), infinity);
  if (bodies.are_entries_asked)
    return scales;
  const Index kept = answer.values.rows();
  const auto energy = [&](const VectorXd& potentials) {
    return potentials.head(kept).dot(answer.values * potentials.head(kept));
  };
  for (Index k = 0; k < scales.size(); ++k) {
    const auto& [name, sense, drive] = bodies.readings[static_cast<std::size_t>(k)];
    scales[k] = std::max(std::abs(sense.head(kept).dot(answer.values * drive.head(kept))),
                         least_part * std::sqrt(energy(sense) * energy(drive)));
  }
  return scales;
}

Eigen::ArrayXXd error_scales(const MatrixXd& values, const ChargedBodies& bodies) {
  if (!bodies.are_entries_asked) {
    Eigen::ArrayXXd none = Eigen::ArrayXXd::Constant(values.rows(), values.cols(), infinity);
    // Where no changes are asked for, a reading is a sensor's own entry.
    if (bodies.readings.empty())
      for (Index i = 0; i < none.rows(); ++i)
        if (bodies.conductors[static_cast<std::size_t>(i)].is_asked)
          none(i, i) = values(i, i);
    return none;
  }
  const VectorXd roots = values.diagonal().cwiseSqrt();
  Eigen::ArrayXXd scales = values.array().abs().max(least_part * (roots * roots.transpose()).array());
  // Where targets are marked, the charges on the other objects are of no interest.
  std::vector<bool> is_partner(bodies.conductors.size(), true);
  if (std::any_of(bodies.bodies.begin(), bodies.bodies.end(),
                  [](const auto& body) { return body.is_target; })) {
    for (std::size_t k = 0; k < is_partner.size(); ++k)
      is_partner[k] = bodies.conductors[k].is_asked;
    for (const ChargedBody& body : bodies.bodies)
      if (body.is_target)
        is_partner[body.conductor] = true;
  }
  for (Index i = 0; i < scales.rows(); ++i)
    for (Index j = 0; j < scales.cols(); ++j) {
      const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
      const bool is_asked = (bodies.conductors[row].is_asked && is_partner[column]) ||
                            (bodies.conductors[column].is_asked && is_partner[row]);
      if (!is_asked)
        scales(i, j) = infinity;
    }
  return scales;
}

double largest_error(const MaxwellMatrix& answer, const ChargedBodies& bodies) {
  const double of_entries = (answer.errors.array() / error_scales(answer.values, bodies)).maxCoeff();
  if (bodies.readings.empty())
    return of_entries;
  return std::max({of_entries, errors_of_changes(answer.readings).maxCoeff(),
                   errors_of_values(answer.readings).cwiseQuotient(value_scales(answer, bodies)).maxCoeff()});
}

double largest_geometry_error(const MaxwellMatrix& answer, const ChargedBodies& bodies,
                              const GeometryErrors& geometry) {
  const double of_entries = (geometry.entries.array() / error_scales(answer.values, bodies)).maxCoeff();
  if (bodies.readings.empty())
    return of_entries;
  return std::max({of_entries,
                   geometry.readings.change.cwiseQuotient(change_scales(answer.readings)).maxCoeff(),
                   geometry.readings.value.cwiseQuotient(value_scales(answer, bodies)).maxCoeff()});
}

double excess_error(const MaxwellMatrix& answer, const ChargedBodies& bodies, const GeometryErrors& geometry,
                    double rtol) {
  const auto excess = [&](const Eigen::ArrayXXd& errors, const Eigen::ArrayXXd& by_geometry) {
    const double by_surfaces = by_geometry.maxCoeff();
    const double rest = rtol - by_surfaces;
    const double allowed = !geometry.are_of_facets ? std::max(rest, by_surfaces)
                           : rest >= rtol / 2      ? rest
                                                   : rtol;
    return (errors - by_geometry).maxCoeff() / allowed;
  };
  const Eigen::ArrayXXd scales = error_scales(answer.values, bodies);
  const double of_entries = excess(answer.errors.array() / scales, geometry.entries.array() / scales);
  if (bodies.readings.empty())
    return of_entries;
  const VectorXd scales_of_values = value_scales(answer, bodies);
  return std::max({of_entries,
                   excess(errors_of_changes(answer.readings),
                          geometry.readings.change.cwiseQuotient(change_scales(answer.readings))),
                   excess(errors_of_values(answer.readings).cwiseQuotient(scales_of_values),
                          geometry.readings.value.cwiseQuotient(scales_of_values))});
}

bool Progress::is_in_vain(double excess, std::size_t unknowns) {
  /// Unknowns from which a refinement takes half a minute or more.
  constexpr std::size_t many = 8000;
  /// Factor that a refinement has to gain, and how many of them in succession may not.
  constexpr double least_gain = 0.9;
  constexpr int most_vain_steps = 2;
  vain_steps_ = excess > least_gain * best_ ? vain_steps_ + 1 : 0;
  best_ = std::min(best_, excess);
  return unknowns >= many && vain_steps_ >= most_vain_steps;
}

}  // namespace fringe::detail
