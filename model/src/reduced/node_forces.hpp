#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/wrench.hpp"
#include "reduced/node_kernels.hpp"

namespace fringe::detail {

/// Nodes with charges: a row for every node.
struct ChargedNodes {
  NodePoints points;
  Eigen::MatrixXf charges;
};

/// Computes, for every two consecutive columns of charges p and q, the derivatives of −(p, q) − (q, p) as the
/// outer nodes move, where (p, q) is the energy between p on the outer nodes and q on the inner ones. Torques
/// are about the origin of the coordinates.
std::vector<Wrench> node_forces(const NodeMatrix& inverse_distances, const ChargedNodes& outer,
                                const ChargedNodes& inner);

}  // namespace fringe::detail
