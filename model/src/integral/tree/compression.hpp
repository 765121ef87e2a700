#pragma once

#include <vector>

#include <Eigen/Core>

#include "integral/tree/moments.hpp"

namespace fringe::detail {

/// The coordinates in which points are compressed: the centre, the radius and the principal axes (columns) of
/// the surface they represent. A smooth surface is thin along its normal, and most moments that involve this
/// direction need no points.
struct CompressionFrame {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;
  double radius;
};

/// Selects a few of the points and gives them weights with the same moments up to the degree (at most 5),
/// except moments that hardly contribute (model/NUMERICS.md, section 11). The weights of the candidates must
/// be positive. The resulting weights are positive too, except that they may fall below zero by some
/// thousandths of their mean.
std::vector<WeightedPoint> compress(const std::vector<WeightedPoint>& candidates,
                                    const CompressionFrame& frame, int degree);

}  // namespace fringe::detail
