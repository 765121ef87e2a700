#pragma once

#include <span>

#include "fringe/method.hpp"
#include "fringe/triangle.hpp"
#include "geometry/plate_frame.hpp"

namespace fringe::detail {

/// ∫dA/min_k d_k over a triangle by a method that sums over nodes, each node with the plate nearest to it:
/// the centroid of each small triangle for Split, each node of the product rule for Gauss.
double nearest_node_sum(const Triangle& triangle, std::span<const PlateFrame> plates, const Split& split);
double nearest_node_sum(const Triangle& triangle, std::span<const PlateFrame> plates, const Gauss& gauss);

}  // namespace fringe::detail
