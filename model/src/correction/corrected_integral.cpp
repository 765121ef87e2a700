#include "correction/corrected_integral.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "correction/formula.hpp"
#include "correction/two_surfaces.hpp"
#include "fringe/batch_integral.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// Factor c of the correction `constant`, from the mean logarithm of truth over model in the set-ups that are
/// not sealed (model/CORRECTIONS.md).
constexpr double constant_factor = 1.295;

/// Returns sin θ/θ, where θ is the angle between the triangle and the plate.
double arc_factor(const Vector3d& normal, const Rectangle& plate) {
  const Vector3d plate_normal = plate.edge_u.cross(plate.edge_v).normalized();
  const double sine = normal.cross(plate_normal).norm(),
               angle = std::atan2(sine, std::abs(normal.dot(plate_normal)));
  return angle > 0 ? sine / angle : 1;
}

/// Returns the relative gain by its edge of a disc as large as the plate, at the given distance.
double kirchhoff_factor(double distance, const Rectangle& plate) {
  const double circumference = pi * std::sqrt(plate.edge_u.norm() * plate.edge_v.norm() / pi);
  // Beyond the formula's range of validity the term would become negative.
  return 1 + std::max(0.0, distance / circumference * (std::log(16 * circumference / distance) - 1));
}

/// Returns Palmer's factor for the edges of the plate at the given distance.
double palmer_factor(double distance, const Rectangle& plate) {
  double factor = 1;
  for (const double length : {plate.edge_u.norm(), plate.edge_v.norm()})
    factor *= 1 + std::max(0.0, distance / (pi * length) * (1 + std::log(2 * pi * length / distance)));
  return factor;
}

/// Computes Σ I·factor over the triangles; the factor depends on the triangle's mean distance A/I.
template <class Factor>
double sum_of(const ChargedSurface& object, const TriangleBatch& batch, std::span<const Rectangle> plates,
              const Factor& factor) {
  double sum = 0;
  for (const Rectangle& plate : plates) {
    const std::vector<double> integrals = plate_integrals(batch, plate);
    for (std::size_t i = 0; i < integrals.size(); ++i)
      if (integrals[i] > 0)
        sum += integrals[i] * factor(plate, batch.twice_area()[i] / 2 / integrals[i], object.normals[i]);
  }
  return sum;
}

/// Returns Σ∫dA/d without a correction.
double plain(const TriangleBatch& batch, std::span<const Rectangle> plates) {
  double sum = 0;
  for (const BoundedIntegral& total : total_integrals(batch, plates))
    sum += total.value;
  return sum;
}

}  // namespace

double corrected_integral(Correction correction, const ChargedSurface& object, const TriangleBatch& batch,
                          const ChargedSurface& sensor, const Eigen::Isometry3d& sensor_pose,
                          std::span<const Rectangle> plates) {

  switch (correction) {
  case Correction::none:
    return plain(batch, plates);
  case Correction::constant:
    return constant_factor * plain(batch, plates);
  case Correction::arc:
    return sum_of(object, batch, plates, [](const Rectangle& plate, double, const Vector3d& normal) {
      return arc_factor(normal, plate);
    });
  case Correction::kirchhoff:
    return sum_of(object, batch, plates, [](const Rectangle& plate, double distance, const Vector3d&) {
      return kirchhoff_factor(distance, plate);
    });
  case Correction::palmer:
    return sum_of(object, batch, plates, [](const Rectangle& plate, double distance, const Vector3d&) {
      return palmer_factor(distance, plate);
    });
  case Correction::reciprocity:
    return reciprocal_integral(object, plates, plain(batch, plates));
  case Correction::two_sided_arc:
    return two_sided_arcs(object, plates);
  case Correction::formula:
  case Correction::recommended:
    return formula(formula_terms(object, sensor, sensor_pose, plates));
  }
  return plain(batch, plates);
}

}  // namespace fringe::detail
