#pragma once

#include <vector>

#include <Eigen/Core>

#include "integral/tree/weighted_point.hpp"

namespace fringe::detail {

/// The coordinates in which points are compressed: the centre, the size and the principal axes (columns) of
/// what they stand for. Along its normal a smooth surface is thin, and most moments that involve it need no
/// points.
struct CompressionFrame {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;
  double radius;
};

/// A few of the points with weights that give the same moments up to the degree (at most 5), but for those
/// that hardly contribute (model/NUMERICS.md, section 11). The weights of the candidates must be positive; so
/// are those of the result, but for some thousandths of their mean.
std::vector<WeightedPoint> compress(const std::vector<WeightedPoint>& candidates,
                                    const CompressionFrame& frame, int degree);

}  // namespace fringe::detail
