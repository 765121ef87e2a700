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

/// The world poses of a scene's links, with a record of which links have moved relative to each other.
class LinkMotion {
 public:
  explicit LinkMotion(const std::vector<Link>& links);

  /// Replaces a link's pose relative to its parent. Throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Updates the world poses of the links that were moved and of their descendants.
  void update();

  /// Forgets all moves so far: rigid() then compares with the present poses.
  void settle();

  /// Returns whether bodies attached to two links kept their relative pose since settle(): whether the
  /// nearest moved link at or above each is the same.
  bool rigid(std::optional<std::size_t> a, std::optional<std::size_t> b) const {
    return mover(a) == mover(b);
  }

  /// Returns the world pose of a body that is attached to a link, or to the world itself.
  Eigen::Isometry3d world_pose(std::optional<std::size_t> link) const {
    return link ? world_poses_[*link] : Eigen::Isometry3d::Identity();
  }

 private:
  static constexpr std::size_t nobody = static_cast<std::size_t>(-1);

  std::size_t mover(std::optional<std::size_t> link) const { return link ? movers_[*link] : nobody; }

  std::vector<Link> links_;
  std::unordered_map<std::string, std::size_t> indices_;  ///< index of each link by its name
  std::vector<std::size_t> parents_first_;
  std::vector<Eigen::Isometry3d> world_poses_;
  std::vector<bool> moved_;
  std::vector<std::size_t> movers_;  ///< for each link, the nearest moved link at or above it
};

}  // namespace fringe::detail
