#pragma once

#include <Eigen/Core>

namespace fringe::detail {

struct WeightedPoint {
  Eigen::Vector3d position;
  double weight;
};

}  // namespace fringe::detail
