#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"

namespace fringe::detail {

/// Tells whether two poses differ only by the rounding of products of a few, for bodies of a size in m.
bool are_equal(const Eigen::Isometry3d& one, const Eigen::Isometry3d& other, double size = 1);

/// The poses of a scene's links, and when each of them was last replaced. A LiveScene has one, which all of
/// its evaluators share.
class LinkPoses {
 public:
  explicit LinkPoses(const std::vector<Link>& links);

  /// Replaces a link's pose relative to its parent. Throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Updates the world poses of the links that were moved and of their descendants.
  void update();

  /// Counts the poses replaced so far.
  std::uint64_t changes() const { return changes_; }

  /// Returns the value of changes() after the link's pose was last replaced; 0 if it never was.
  std::uint64_t last_change(std::size_t link) const { return last_changes_[link]; }

  const std::vector<Link>& links() const { return links_; }

  /// A link's index and that of its parent; `nobody` for a root.
  struct Node {
    std::size_t link;
    std::size_t parent;
  };
  static constexpr std::size_t nobody = static_cast<std::size_t>(-1);

  /// Returns all links, each after its parent.
  const std::vector<Node>& parents_first() const { return parents_first_; }

  /// Returns the world pose, as of the last update(), of a body that is attached to a link or to the world.
  Eigen::Isometry3d world_pose(std::optional<std::size_t> link) const {
    return link ? world_poses_[*link] : Eigen::Isometry3d::Identity();
  }

 private:
  std::vector<Link> links_;
  std::unordered_map<std::string, std::size_t> indices_;  ///< index of each link by its name
  std::vector<Node> parents_first_;
  std::vector<Eigen::Isometry3d> world_poses_;
  std::vector<char> outdated_;  ///< whether a link's world pose awaits update()
  std::vector<std::uint64_t> last_changes_;
  std::uint64_t changes_ = 0;
  std::uint64_t updated_ = 0;  ///< value of changes() at the last update()
};

/// Tells one evaluator which links have moved relative to each other since its own last answer.
class LinkMotion {
 public:
  explicit LinkMotion(std::shared_ptr<LinkPoses> poses);

  /// Replaces a link's pose relative to its parent, for all who share the poses. Throws InputError when no
  /// link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) { poses_->set_pose(link, pose); }

  /// Updates the world poses, and what rigid() says.
  void update();

  /// Forgets all moves so far: rigid() then compares with the poses of the last update().
  void settle() { settled_ = updated_; }

  /// Returns whether bodies attached to two links kept their relative pose since settle(): whether the
  /// nearest moved link at or above each is the same.
  bool rigid(std::optional<std::size_t> a, std::optional<std::size_t> b) const {
    return mover(a) == mover(b);
  }

  /// Returns the world pose of a body that is attached to a link, or to the world itself.
  Eigen::Isometry3d world_pose(std::optional<std::size_t> link) const { return poses_->world_pose(link); }

  const LinkPoses& poses() const { return *poses_; }

 private:
  static constexpr std::size_t nobody = LinkPoses::nobody;

  std::size_t mover(std::optional<std::size_t> link) const { return link ? movers_[*link] : nobody; }

  std::shared_ptr<LinkPoses> poses_;
  std::vector<std::size_t> movers_;  ///< for each link, the nearest moved link at or above it
  std::uint64_t updated_ = 0;        ///< changes of the poses at the last update()
  std::uint64_t settled_ = 0;        ///< changes of the poses that settle() has forgotten
};

}  // namespace fringe::detail
