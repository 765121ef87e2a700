#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/panel.hpp"

namespace fringe::detail {

/// A charge beside a body.
struct OutsideCharge {
  Eigen::Vector3d point;
  double charge;
};

/// Charges all around a body, at distances from a tenth of its size to several times it, such that those of
/// every distance together do as much to it (model/BOUNDARY_ELEMENTS.md, section 8). The body's half size is
/// about 1; a closed one has none inside.
std::vector<OutsideCharge> outside_charges(std::span<const Triangle> triangles,
                                           std::span<const Panel> panels);

}  // namespace fringe::detail
