#include "fringe/surface_charges.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "bem/conductors_at_rest.hpp"
#include "bem/panel_pair.hpp"
#include "bem/single_layer_panels.hpp"
#include "fringe/error.hpp"
#include "numeric/parallel.hpp"
#include "surface/bodies.hpp"

namespace fringe {
namespace {

using detail::ChargedBodies;
using detail::Panel;
using detail::Role;
using Eigen::ArrayXf;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Asks for sensors and electrodes alone, where there are any.
void ask_for_driven(ChargedBodies& bodies) {
  const auto is_driven = [](const detail::ChargedConductor& conductor) {
    return conductor.role == Role::sensor || conductor.role == Role::electrode;
  };
  if (std::ranges::any_of(bodies.conductors, is_driven))
    for (detail::ChargedConductor& conductor : bodies.conductors)
      conductor.is_asked = is_driven(conductor);
}

std::vector<Panel> panels_of(std::span<const Triangle> triangles) {
  std::vector<Panel> panels;
  panels.reserve(triangles.size());
  for (const Triangle& triangle : triangles)
    panels.push_back(detail::make_panel(triangle));
  return panels;
}

}  // namespace

SurfaceCharges surface_charges(const Scene& scene, const SurfaceChargeOptions& options) {
  if (!(options.rtol >= 1e-4 && options.rtol <= 0.5))
    throw InputError(fmt::format("rtol {} must be from 0.0001 to 0.5", options.rtol));
  if (scene.has_room)
    throw InputError("room: boundary elements compute only conductors in free space");
  ChargedBodies all = detail::charged_bodies(scene);
  ask_for_driven(all);
  const detail::ConductorsAtRest found(std::move(all), options.rtol, options.most_panels, 0, options.threads);
  const ChargedBodies& bodies = found.bodies();
  SurfaceCharges result;
  result.error = found.error();
  for (const Panel& panel : found.mesh().panels())
    result.panels.push_back(panel.corners);
  for (const detail::PanelGroup& group : found.mesh().groups())
    result.conductor_of.insert(result.conductor_of.end(), group.count, bodies.bodies[group.body].conductor);
  for (const detail::ChargedConductor& conductor : bodies.conductors)
    result.conductors.push_back(conductor.name);
  result.charges = found.charges();
  return result;
}

MatrixXd single_layer(std::span<const Triangle> triangles, double tolerance) {
  const MatrixXd upper = detail::single_layer_matrix(panels_of(triangles), tolerance);
  return upper.selfadjointView<Eigen::Upper>();
}

TrianglePotentials triangle_potentials(std::span<const Vector3d> points, std::span<const Triangle> triangles,
                                       std::size_t threads) {
  /// Distance from a triangle's centre, over its radius, beyond which it counts as a point.
  constexpr float far = 10;
  const auto count = static_cast<Index>(triangles.size());
  ArrayXf x(count), y(count), z(count), near(count);
  for (Index k = 0; k < count; ++k) {
    const Panel panel = detail::make_panel(triangles[static_cast<std::size_t>(k)]);
    x[k] = static_cast<float>(panel.centre.x());
    y[k] = static_cast<float>(panel.centre.y());
    z[k] = static_cast<float>(panel.centre.z());
    near[k] = static_cast<float>(far * panel.radius * far * panel.radius);
  }
  TrianglePotentials result(static_cast<Index>(points.size()), count);
  constexpr std::size_t together = 16;
  detail::parallel_for((points.size() + together - 1) / together, threads, [&](std::size_t part) {
    ArrayXf squared(count);
    std::vector<Index> close;
    for (std::size_t p = part * together; p < std::min(points.size(), (part + 1) * together); ++p) {
      const Eigen::Vector3f point = points[p].cast<float>();
      squared = (x - point.x()).square() + (y - point.y()).square() + (z - point.z()).square();
      auto row = result.row(static_cast<Index>(p)).array();
      row = squared.transpose().rsqrt();
      close.clear();
      for (Index k = 0; k < count; ++k)
        if (squared[k] < near[k])
          close.push_back(k);
      VectorXd exact = VectorXd::Zero(static_cast<Index>(close.size()));
      detail::PotentialSums sums;
      for (std::size_t k = 0; k < close.size(); ++k)
        sums.add(triangles[static_cast<std::size_t>(close[k])], points[p], 1, exact[static_cast<Index>(k)]);
      sums.flush();
      for (std::size_t k = 0; k < close.size(); ++k)
        row[close[k]] = static_cast<float>(exact[static_cast<Index>(k)]);
    }
  });
  return result;
}

}  // namespace fringe
