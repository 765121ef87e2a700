#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/rectangle.hpp"
#include "fringe/scene.hpp"
#include "fringe/triangle.hpp"

namespace fringe {

/// Returns the pose that rotates about an axis (of any nonzero length) by an angle in degrees, then
/// translates.
Eigen::Isometry3d pose_from_axis(const Eigen::Vector3d& axis, double degrees,
                                 const Eigen::Vector3d& translation);

/// Returns the pose that rotates by a quaternion (of any nonzero length), then translates.
Eigen::Isometry3d pose_from_quaternion(const Eigen::Quaterniond& quaternion,
                                       const Eigen::Vector3d& translation);

/// Returns the pose p ↦ rotation·p + translation. Throws InputError unless everything is finite and
/// rotation·rotationᵀ is the identity to 1e-9 with determinant +1.
Eigen::Isometry3d pose_from_matrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation);

/// Computes the pose of every link in the world, in the links' order. The links' parents must form trees, as
/// load_scene ensures.
std::vector<Eigen::Isometry3d> world_poses(const std::vector<Link>& links);

/// Returns the world pose of a link, or the identity for something attached to the world itself.
Eigen::Isometry3d attachment_pose(const std::vector<Eigen::Isometry3d>& link_poses,
                                  std::optional<std::size_t> link);

/// Returns the index of the link of that name. Throws InputError if there is none.
std::size_t find_link(const std::vector<Link>& links, std::string_view name);

/// Replaces a link's pose relative to its parent. Throws InputError when no link has the name.
void set_pose(Scene& scene, std::string_view link_name, const Eigen::Isometry3d& pose);

/// Moves a rectangle or a triangle by a pose.
Rectangle transformed(const Rectangle& rectangle, const Eigen::Isometry3d& pose);
Triangle transformed(const Triangle& triangle, const Eigen::Isometry3d& pose);

}  // namespace fringe
