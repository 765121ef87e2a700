#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

namespace fringe {

struct Link;

/// A joint, which turns or shifts a link relative to its parent. Positions are in rad (revolute) or m
/// (prismatic).
struct Joint {
  enum class Kind { revolute, prismatic };

  /// The position follows that of another joint: multiplier·position + offset.
  struct Mimic {
    std::string joint;
    double multiplier = 1;
    double offset = 0;
  };

  std::string name;
  Kind kind = Kind::revolute;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();         ///< in the link's frame, of any nonzero length
  Eigen::Isometry3d rest = Eigen::Isometry3d::Identity();  ///< the link's pose at position 0
  double position = 0;
  std::optional<double> lower =
      std::nullopt;  ///< limits, for information: a position beyond them is not refused
  std::optional<double> upper = std::nullopt;
  std::optional<Mimic> mimic = std::nullopt;
};

/// Returns the pose of a joint's link relative to its parent.
Eigen::Isometry3d pose_at(const Joint& joint, double position);

/// The pose of a link relative to its parent, by its index.
struct LinkPose {
  std::size_t link;
  Eigen::Isometry3d pose;
};

/// Returns the poses that links take when a joint is at a position: those of its own link and of all links
/// whose joints follow it. Throws InputError when there is no such joint, when it follows another one, or
/// when the position is not finite.
std::vector<LinkPose> joint_poses(const std::vector<Link>& links, std::string_view joint, double position);

/// Sets the positions of joints that follow others, and the poses of all links that have joints. Throws
/// InputError with the joint's name and the reason if a joint follows one that does not exist, or itself.
void place_joints(std::vector<Link>& links);

}  // namespace fringe
