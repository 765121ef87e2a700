#pragma once

#include <Eigen/Geometry>

#include "fringe/boundary_elements.hpp"
#include "geometry.hpp"

/// Random poses for the tests of the reduced method, and the comparison of its answers with the truth.
namespace fringe::test {

/// Returns a pose at a point, turned by up to half a turn about a nearly horizontal axis.
inline Eigen::Isometry3d turned_at(const Eigen::Vector3d& point, Random& random) {
  const double angle = random.uniform(0, 3);
  Eigen::Isometry3d pose(Eigen::Translation3d{point});
  pose.rotate(Eigen::AngleAxisd(angle, random.in_box({-1, -1, 0.3}, {1, 1, 0.3}).normalized()));
  return pose;
}

/// Returns true if an answer and the truth differ by no more than their stated errors together.
inline bool covers(const MaxwellMatrix& answer, const MaxwellMatrix& truth) {
  return ((answer.values - truth.values).array().abs() <= (answer.errors + truth.errors).array()).all() &&
         ((answer.delta_self - truth.delta_self).array().abs() <=
          (answer.delta_self_errors + truth.delta_self_errors).array())
             .all();
}

}  // namespace fringe::test
