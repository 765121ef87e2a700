#include "formula/formula.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formula/facing_flux.hpp"
#include "geometry/plate_frame.hpp"
#include "integral/batch/kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::VectorXd;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Constants of the formula (no unit), fitted once to the set-ups that are not sealed
/// (`analysis/topics/corrections/fit.py` at commit 514eedd7).
constexpr double linear_stiffness = 1.969;     ///< weight of linear variation in the polarisability
constexpr double quadratic_stiffness = 2.213;  ///< weight of quadratic variation
constexpr double remaining_stiffness = 8.175;  ///< weight of remaining variation
constexpr double fringe = 2.369;        ///< weight of the fringing flux at the border of the facing area
constexpr double attraction = 3.795;    ///< weight of the mutual attraction of the charges
constexpr double saturation = 0.217;    ///< limits the polarisability to 1/saturation
constexpr double tilt = 0.795;          ///< weight of the near flux between tilted sides
constexpr double fringe_near = -1.866;  ///< change of the fringing flux per coupling

/// Computes the potentials, over 4π, at the nodes of the object (rows) of unit charges at the nodes of the
/// sensor (columns).
RowMatrix coupling(const ChargedSurface& object, const ChargedSurface& sensor,
                   const Eigen::Isometry3d& sensor_pose, double squared_softness) {
  constexpr auto lanes = static_cast<Eigen::Index>(TriangleArrays::padding);
  const Eigen::Index stride = (sensor.nodes.cols() + lanes - 1) / lanes * lanes;
  RowMatrix columns(3, stride);
  columns.leftCols(sensor.nodes.cols()) = sensor_pose * sensor.nodes;
  for (Eigen::Index i = sensor.nodes.cols(); i < stride; ++i)
    columns.col(i) = columns.col(0);
  RowMatrix inverse_distances(object.nodes.cols(), stride);
  best_kernels<BatchKernels>().soft_inverse_distances(
      {columns.data(), columns.data() + stride, columns.data() + 2 * stride},
      static_cast<std::size_t>(stride), object.nodes.data(), static_cast<std::size_t>(object.nodes.cols()),
      squared_softness, inverse_distances.data());
  return inverse_distances.leftCols(sensor.nodes.cols()) / (4 * std::numbers::pi);
}

/// Computes the relative variances of a potential's deviation from its mean.
FormulaTerms::Variation variation(const ChargedSurface& surface, const VectorXd& deviation, double mean) {
  const VectorXd parts = surface.modes * deviation;
  const double linear = parts.head(surface.linear_modes).squaredNorm(), both = parts.squaredNorm(),
               all = std::max(both, surface.charges.dot(deviation.cwiseAbs2())), squared = mean * mean;
  return {linear / squared, (both - linear) / squared, (all - both) / squared};
}

/// Returns the relative increase of a body's charge because the potential varies over it, for a coupling of
/// 1.
double polarisability(const FormulaTerms::Variation& variation) {
  const double value = linear_stiffness * variation.linear + quadratic_stiffness * variation.quadratic +
                       remaining_stiffness * variation.remaining;
  return value / (1 + saturation * value);
}

/// Returns the area over the own capacitance: the gap at which the near and the far capacitance are equal.
double own_gap(const ChargedSurface& surface) {
  return surface.area / (surface.closed ? 2 : 1) / surface.own_capacitance;
}

/// Adds the flux between an object and one plate, cluster by cluster where the gap is large enough.
void add_facing_flux(FacingFlux& flux, const ChargedSurface& object, const Rectangle& rectangle,
                     double softness) {
  const FacingPlate plate(rectangle);
  const PlateFrame frame = plate_frame(rectangle);
  // If the gap exceeds this many radii, the cluster's extent and curvature change its contribution by less
  // than a hundredth.
  constexpr double far = 4;
  for (const Cluster& cluster : object.clusters) {
    if (distance(frame, frame.axes * (cluster.centre - frame.corner)) > far * cluster.radius) {
      add_facing_flux(flux, cluster.stand_in, cluster.normal, cluster.area, object.closed, plate, softness);
      continue;
    }
    for (const std::size_t i : cluster.members)
      add_facing_flux(flux, object.triangles[i], object.normals[i], object.areas[i], object.closed, plate,
                      softness);
  }
}

}  // namespace

FormulaTerms formula_terms(const ChargedSurface& object, const ChargedSurface& sensor,
                           const Eigen::Isometry3d& sensor_pose, std::span<const Rectangle> plates) {
  const double softness = 1 / std::hypot(1 / own_gap(object), 1 / own_gap(sensor));
  const RowMatrix potentials = coupling(object, sensor, sensor_pose, softness * softness);
  VectorXd on_object = potentials * sensor.charges, on_sensor = potentials.transpose() * object.charges;
  const double mean = object.charges.dot(on_object);
  on_object.array() -= mean;
  on_sensor.array() -= mean;

  FormulaTerms terms;
  terms.own_of_sensor = sensor.own_capacitance;
  terms.own_of_object = object.own_capacitance;
  terms.potential = mean;
  terms.on_sensor = variation(sensor, on_sensor, mean);
  terms.on_object = variation(object, on_object, mean);
  terms.drawn =
      object.charges.cwiseProduct(on_object).dot(potentials * sensor.charges.cwiseProduct(on_sensor)) /
      (mean * mean * mean);
  FacingFlux flux;
  for (const Rectangle& plate : plates)
    add_facing_flux(flux, object, plate, softness);
  terms.flux = flux.flux;
  terms.soft_flux = flux.soft_flux;
  terms.tilted_excess = flux.tilted_excess;
  terms.facing_area = flux.area;
  return terms;
}

double formula(const FormulaTerms& terms) {
  const double own_product = terms.own_of_object * terms.own_of_sensor;
  const double coupled = terms.potential * terms.potential * own_product;
  const double drawn_factor = 1 + attraction * coupled * terms.drawn;
  const double polarised =
      (1 + coupled * polarisability(terms.on_object)) * (1 + coupled * polarisability(terms.on_sensor));
  // The softened coupling of nearly touching bodies stays well below 1; this bound only preserves the sign.
  constexpr double least = 0.02;
  const double determinant = std::max(1 / polarised - coupled * drawn_factor * drawn_factor, least);
  const double far = terms.potential * own_product * drawn_factor / determinant;
  if (terms.flux == 0 || std::isinf(terms.flux))
    return far + terms.flux;
  const double fringes = fringe * (1 + fringe_near * coupled) * std::sqrt(terms.facing_area) *
                         std::log(terms.flux / terms.soft_flux);
  return far + (terms.flux - terms.soft_flux) + tilt * terms.tilted_excess + fringes;
}

}  // namespace fringe::detail
