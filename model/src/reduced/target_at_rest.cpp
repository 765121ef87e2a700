#include "reduced/target_at_rest.hpp"

#include <functional>
#include <span>
#include <utility>

#include "reduced/node_kernels.hpp"
#include "reduced/prepared_shape.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Returns the importance of dividing a part of a target.
double importance_for(const ChargeFunctions::Part& part, const Approach& approach) {
  const double size = approach.relative_size(part.box);
  return size * size * part.density / part.density_of_body;
}

}  // namespace

TargetAtRest::TargetAtRest(ChargedBodies bodies, const SurfaceResolution& resolution,
                           const Approach& approach)
    : TargetAtRest(ConductorsAtRest(std::move(bodies), resolution.rtol, resolution.most_panels,
                                    4 * resolution.functions, resolution.threads,
                                    std::bind_front(&Approach::relative_size, &approach)),
                   resolution, approach) {}

TargetAtRest::TargetAtRest(const ConductorsAtRest& conductors, const SurfaceResolution& resolution,
                           const Approach& approach)
    : functions_(
          conductors, MatrixXd(index_of(conductors.mesh().panels().size()), 0),
          [&](const ChargeFunctions::Part& part) { return importance_for(part, approach); },
          resolution.functions),
      coarse_(functions_, MatrixXd(index_of(functions_.count()), 0), VectorXd(0)), rtol_(resolution.rtol),
      error_(conductors.error()) {
  const FunctionPanels& panels = functions_.panels();
  for (std::size_t function = 0; function < functions_.count(); ++function)
    parts_.push_back(placed_box(
        std::span(panels.corners)
            .subspan(panels.first[function], panels.first[function + 1] - panels.first[function])));
  const ChargedBodies& bodies = conductors.bodies();
  const MatrixXd inverse = charges_by_potentials(functions_.energies());
  inverse_ = stored(inverse);
  // Grounded targets are one conductor here.
  std::vector<VectorXd> columns;
  const MatrixXd net = functions_.net(bodies.conductors.size());
  VectorXd grounded = VectorXd::Zero(net.rows());
  std::vector<double> to_ground;
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k)
    if (bodies.conductors[k].role == Role::floating) {
      floating_.push_back(static_cast<Index>(columns.size()));
      columns.emplace_back(net.col(static_cast<Index>(k)));
      to_ground.push_back(bodies.conductors[k].to_ground);
    } else {
      grounded += net.col(static_cast<Index>(k));
    }
  if (!grounded.isZero(0))
    columns.push_back(grounded);
  MatrixXd ones(net.rows(), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    ones.col(static_cast<Index>(k)) = columns[k];
  net_ = ones;
  equilibrium_ = inverse * ones;
  to_ground_ = Eigen::Map<const VectorXd>(to_ground.data(), static_cast<Index>(to_ground.size()));
}

double TargetAtRest::distance(std::size_t function, const PlacedBox& box, const Isometry3d& pose) const {
  /// Ratio of a function's radius to the distance of its centre below which the two distances hardly differ.
  constexpr double small = 0.3;
  double distance = box.distance(pose * functions_.centre(function));
  if (functions_.radius(function) < small * distance)
    return distance;
  const Isometry3d to_part = pose.inverse(Eigen::Isometry) * box.to_box.inverse(Eigen::Isometry);
  distance = std::min(distance, parts_[function].distance(to_part * box.box.center()));
  for (int corner = 0; corner < 8; ++corner)
    distance = std::min(
        distance,
        parts_[function].distance(to_part * box.box.corner(static_cast<AlignedBox3d::CornerType>(corner))));
  return distance;
}

double TargetAtRest::size() const {
  AlignedBox3d box;
  for (const AlignedBox3d& each : functions_.boxes())
    box.extend(each);
  return box.diagonal().norm();
}

}  // namespace fringe::detail
