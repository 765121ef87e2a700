#include "formula.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../batch/kernels.hpp"
#include "facing_flux.hpp"

namespace fringe::detail {
namespace {

using Eigen::VectorXd;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Fitted to the set-ups that are not sealed: `python3 -m analysis corrections --fit`.
constexpr double linear_stiffness = 2.080;
constexpr double quadratic_stiffness = 2.368;
constexpr double remaining_stiffness = 8.464;
constexpr double fringe = 2.308;
constexpr double attraction = 3.783;
constexpr double saturation = 0.264;
constexpr double tilt = 0.766;
constexpr double fringe_near = -1.883;

/// Potentials at the nodes of the object (rows) by charges at the nodes of the sensor (columns), over 4π.
RowMatrix coupling(const ChargedSurface& object, const ChargedSurface& sensor,
                   const Eigen::Isometry3d& sensor_pose, double squared_softness) {
  constexpr auto lanes = static_cast<Eigen::Index>(TriangleArrays::padding);
  const Eigen::Index stride = (sensor.nodes.cols() + lanes - 1) / lanes * lanes;
  RowMatrix columns(3, stride);
  columns.leftCols(sensor.nodes.cols()) = sensor_pose * sensor.nodes;
  for (Eigen::Index i = sensor.nodes.cols(); i < stride; ++i)
    columns.col(i) = columns.col(0);
  RowMatrix inverse_distances(object.nodes.cols(), stride);
  best_kernels().soft_inverse_distances(
      {columns.data(), columns.data() + stride, columns.data() + 2 * stride}, static_cast<std::size_t>(stride),
      object.nodes.data(), static_cast<std::size_t>(object.nodes.cols()), squared_softness,
      inverse_distances.data());
  return inverse_distances.leftCols(sensor.nodes.cols()) / (4 * std::numbers::pi);
}

/// How much a body's charge gives way to the potential's variation over it, for a coupling of 1: relative variances
/// of the variation's parts, each over the stiffness of the charge against it.
double polarisability(const ChargedSurface& surface, const VectorXd& variation, double mean) {
  const VectorXd parts = surface.modes * variation;
  const double linear = parts.head(surface.linear_modes).squaredNorm(), both = parts.squaredNorm(),
               all = std::max(both, surface.charges.dot(variation.cwiseAbs2()));
  const double value = (linear_stiffness * linear + quadratic_stiffness * (both - linear) +
                        remaining_stiffness * (all - both)) /
                       (mean * mean);
  return value / (1 + saturation * value);
}

/// Area over own capacitance: the gap at which the near and the far capacitance are alike.
double own_gap(const ChargedSurface& surface) {
  return surface.area / (surface.closed ? 2 : 1) / surface.own_capacitance;
}

}  // namespace

double formula(const ChargedSurface& object, const ChargedSurface& sensor,
               const Eigen::Isometry3d& sensor_pose, std::span<const Rectangle> plates) {
  const double softness = 1 / std::hypot(1 / own_gap(object), 1 / own_gap(sensor));

  const RowMatrix potentials = coupling(object, sensor, sensor_pose, softness * softness);
  VectorXd on_object = potentials * sensor.charges, on_sensor = potentials.transpose() * object.charges;
  const double mean = object.charges.dot(on_object);
  on_object.array() -= mean;
  on_sensor.array() -= mean;
  const double own_product = object.own_capacitance * sensor.own_capacitance;
  const double coupled = mean * mean * own_product;
  const double of_object = 1 + coupled * polarisability(object, on_object, mean);
  const double of_sensor = 1 + coupled * polarisability(sensor, on_sensor, mean);
  const double drawn = object.charges.cwiseProduct(on_object)
                           .dot(potentials * sensor.charges.cwiseProduct(on_sensor)) /
                       (mean * mean * mean);
  const double drawn_factor = 1 + attraction * coupled * drawn;
  // What two conductors that nearly touch would make of it is the flux' task; the coupling is kept below 1.
  constexpr double least = 0.02;
  const double determinant =
      std::max(1 / (of_object * of_sensor) - coupled * drawn_factor * drawn_factor, least);
  const double far = mean * own_product * drawn_factor / determinant;

  FacingFlux flux;
  for (const Rectangle& plate : plates)
    for (std::size_t i = 0; i < object.triangles.size(); ++i)
      add_facing_flux(flux, object.triangles[i], object.normals[i], object.closed, plate, softness);
  if (flux.flux == 0)
    return far;
  if (std::isinf(flux.flux))
    return flux.flux;
  const double fringes = fringe * (1 + fringe_near * coupled) * std::sqrt(flux.area) *
                         std::log(flux.flux / flux.soft_flux);
  return far + (flux.flux - flux.soft_flux) + tilt * flux.tilted_excess + fringes;
}

}  // namespace fringe::detail
