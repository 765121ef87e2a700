#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"

namespace fringe::detail {

/// The poses of a scene's links in the world, and which of them have moved relative to each other.
class LinkMotion {
 public:
  explicit LinkMotion(const std::vector<Link>& links);

  /// Replaces a link's pose relative to its parent. Throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Brings the world poses of the links that were moved, and of their descendants, up to date.
  void update();

  /// From here on moves count anew.
  void settle();

  /// Whether what is attached to two links kept its relative pose since settle(): the nearest link above each
  /// that was moved is the same.
  bool rigid(std::optional<std::size_t> a, std::optional<std::size_t> b) const {
    return mover(a) == mover(b);
  }

  /// The pose in the world of what is attached to a link, or to the world itself.
  Eigen::Isometry3d world_pose(std::optional<std::size_t> link) const {
    return link ? world_poses_[*link] : Eigen::Isometry3d::Identity();
  }

 private:
  static constexpr std::size_t nobody = static_cast<std::size_t>(-1);

  std::size_t mover(std::optional<std::size_t> link) const { return link ? movers_[*link] : nobody; }

  std::vector<Link> links_;
  std::unordered_map<std::string, std::size_t> indices_;  ///< of the links, by their names
  std::vector<std::size_t> parents_first_;
  std::vector<Eigen::Isometry3d> world_poses_;
  std::vector<bool> moved_;
  std::vector<std::size_t> movers_;  ///< the nearest moved link at or above each
};

}  // namespace fringe::detail
