#pragma once

#include <Eigen/Geometry>

#include "fringe/boundary_elements.hpp"
#include "geometry.hpp"

/// What the tests of the reduced method draw, and what they hold its answers against.
namespace fringe::test {

/// At a point, turned by up to half a turn about an axis that lies rather flat.
inline Eigen::Isometry3d turned_at(const Eigen::Vector3d& point, Random& random) {
  const double angle = random.uniform(0, 3);
  Eigen::Isometry3d pose(Eigen::Translation3d{point});
  pose.rotate(Eigen::AngleAxisd(angle, random.in_box({-1, -1, 0.3}, {1, 1, 0.3}).normalized()));
  return pose;
}

/// Whether an answer and the truth differ by no more than both state.
inline bool covers(const MaxwellMatrix& answer, const MaxwellMatrix& truth) {
  return ((answer.values - truth.values).array().abs() <= (answer.errors + truth.errors).array()).all() &&
         ((answer.delta_self - truth.delta_self).array().abs() <=
          (answer.delta_self_errors + truth.delta_self_errors).array())
             .all();
}

}  // namespace fringe::test
