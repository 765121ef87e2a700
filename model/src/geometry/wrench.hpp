#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/reading_answer.hpp"
#include "geometry/link_motion.hpp"

/// Derivatives with respect to the poses of rigid bodies.
namespace fringe::detail {

/// The derivatives of a scalar with respect to the pose of a rigid body: per length along the axes, and per
/// angle about the axes through the origin.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();

  Wrench& operator+=(const Wrench& other) {
    force += other.force;
    torque += other.torque;
    return *this;
  }
};

inline Wrench operator*(double factor, const Wrench& wrench) {
  return {factor * wrench.force, factor * wrench.torque};
}

/// Returns a wrench in the frame that a pose leads to.
Wrench in_outer_frame(const Wrench& wrench, const Eigen::Isometry3d& pose);

/// A ball around a body, in the world.
struct BodyBall {
  Eigen::Vector3d centre;
  double radius;
};

/// What two bodies contribute to a scalar that depends on their relative pose: the derivatives with respect
/// to the pose of one of them, in the world, and the links that carry both. Those of the other are opposite.
struct PairWrench {
  std::optional<std::size_t> link;
  std::optional<std::size_t> other;
  Wrench wrench;
  std::optional<BodyBall> smaller = {};  ///< around the smaller body, on which the forces act
};

/// Adds up, for each link, what the pairs contribute of which one body moves with it, on the link itself or
/// on one that hangs on it, and the other does not; about axes through the link's origin. The world poses
/// must be up to date.
std::vector<LinkDerivatives> derivatives_by_link(const LinkPoses& poses, std::span<const PairWrench> pairs);

/// Returns for each link the forces on it, each times the distance of the farthest point of its ball from the
/// link's origin: the torque, had no part of it cancelled.
std::vector<double> moments_by_link(const LinkPoses& poses, std::span<const PairWrench> pairs);

}  // namespace fringe::detail
