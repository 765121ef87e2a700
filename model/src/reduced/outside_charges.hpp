#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "surface/bodies.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {

/// Chooses candidates one by one, each the farthest from those chosen before, until it is nearer than `apart`
/// or there are `most`.
std::vector<Eigen::Vector3d> spread_out(const std::vector<Eigen::Vector3d>& candidates, double apart,
                                        std::size_t most);

/// A point charge beside a body.
struct OutsideCharge {
  Eigen::Vector3d point;
  double charge;
};

/// Places charges all around a body, at distances from a tenth of its size to several times it, such that the
/// charges at each distance together have as much effect on it (model/BOUNDARY_ELEMENTS.md, section 8). The
/// body's half size is about 1; closed surfaces have none inside.
std::vector<OutsideCharge> outside_charges(std::span<const TriangleSurface> surfaces,
                                           std::span<const Panel> panels);

}  // namespace fringe::detail
