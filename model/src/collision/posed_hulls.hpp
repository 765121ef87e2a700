#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "collision/exact_search.hpp"
#include "fringe/convex_shape.hpp"

namespace fringe::detail {

/// Two polytopes in given poses, with positions in integers. The shapes and the poses must outlive it.
class PosedHulls {
 public:
  PosedHulls(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
             const Eigen::Isometry3d& pose_b);
  PosedHulls(const PosedHulls&) = delete;
  PosedHulls& operator=(const PosedHulls&) = delete;

  const ExactHulls& exact() const { return exact_; }

 private:
  std::vector<Eigen::Vector3d> on_a_, on_b_;  ///< relative to B's origin, rounded
  HullPair rounded_;
  ExactHulls exact_;
};

}  // namespace fringe::detail
