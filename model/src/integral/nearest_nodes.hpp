#pragma once

#include <span>

#include "fringe/method.hpp"
#include "fringe/triangle.hpp"
#include "geometry/plate_frame.hpp"

namespace fringe::detail {

/// Computes ∫dA/min_k d_k over a triangle by a sum over nodes, where each node uses the plate nearest to it.
/// The nodes are the centroids of the small triangles for Split and those of the product rule for Gauss.
double nearest_node_sum(const Triangle& triangle, std::span<const PlateFrame> plates, const Split& split);
double nearest_node_sum(const Triangle& triangle, std::span<const PlateFrame> plates, const Gauss& gauss);

}  // namespace fringe::detail
