#include "collision/posed_hulls.hpp"

#include "collision/convex_shape_data.hpp"

namespace fringe::detail {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Returns the rotated vertices plus the offset.
std::vector<Vector3d> moved(const std::vector<Vector3d>& vertices, const Isometry3d& pose,
                            const Vector3d& offset) {
  std::vector<Vector3d> result;
  result.reserve(vertices.size());
  for (const Vector3d& vertex : vertices)
    result.emplace_back(pose.linear() * vertex + offset);
  return result;
}

}  // namespace

PosedHulls::PosedHulls(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                       const Isometry3d& pose_b)
    : on_a_(moved(a.data().vertices, pose_a, pose_a.translation() - pose_b.translation())),
      on_b_(moved(b.data().vertices, pose_b, Vector3d::Zero())),
      rounded_{on_a_, on_b_, Vector3d::Zero(),
               (pose_a.translation() - pose_b.translation()).lpNorm<1>() + a.data().support.reach +
                   b.data().support.reach,
               coordinate_error_of_moved},
      exact_(exact_hulls(rounded_, ExactVertices(a.data().vertices, pose_a),
                         ExactVertices(b.data().vertices, pose_b))) {}

}  // namespace fringe::detail
