#include "geometry/link_motion.hpp"

#include <algorithm>
#include <utility>

#include "fringe/pose.hpp"

namespace fringe::detail {
namespace {

/// Counts the ancestors of a link.
std::size_t depth(const std::vector<Link>& links, std::size_t link) {
  std::size_t above = 0;
  for (std::optional<std::size_t> parent = links[link].parent; parent; parent = links[*parent].parent)
    ++above;
  return above;
}

}  // namespace

bool are_equal(const Eigen::Isometry3d& one, const Eigen::Isometry3d& other, double size) {
  /// Relative rounding error of the product of a few poses, with a margin.
  constexpr double rounding = 1e-12;
  return (one.linear() - other.linear()).norm() <= rounding &&
         (one.translation() - other.translation()).norm() <= rounding * (size + other.translation().norm());
}

LinkPoses::LinkPoses(const std::vector<Link>& links)
    : links_(links), world_poses_(fringe::world_poses(links)), outdated_(links.size()),
      last_changes_(links.size()) {
  std::vector<std::pair<std::size_t, std::size_t>> by_depth;
  for (std::size_t link = 0; link < links.size(); ++link)
    by_depth.emplace_back(depth(links, link), link);
  for (std::size_t link = 0; link < links.size(); ++link)
    indices_.emplace(links[link].name, link);
  std::sort(by_depth.begin(), by_depth.end());
  for (const auto& [above, link] : by_depth)
    parents_first_.push_back({link, links[link].parent.value_or(nobody)});
}

void LinkPoses::set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
  const auto known = indices_.find(std::string(link));
  // For an unknown name, find_link throws the error.
  const std::size_t index = known == indices_.end() ? find_link(links_, link) : known->second;
  links_[index].pose = pose;
  last_changes_[index] = ++changes_;
  outdated_[index] = 1;
}

void LinkPoses::update() {
  if (updated_ == changes_)
    return;
  for (const auto& [link, parent] : parents_first_) {
    if (parent != nobody && outdated_[parent] != 0)
      outdated_[link] = 1;
    if (outdated_[link] != 0)
      world_poses_[link] = world_pose(links_[link].parent) * links_[link].pose;
  }
  std::fill(outdated_.begin(), outdated_.end(), 0);
  updated_ = changes_;
}

LinkMotion::LinkMotion(std::shared_ptr<LinkPoses> poses)
    : poses_(std::move(poses)), movers_(poses_->links().size(), nobody), updated_(poses_->changes()),
      settled_(poses_->changes()) {
  poses_->update();
}

void LinkMotion::update() {
  poses_->update();
  updated_ = poses_->changes();
  for (const auto& [link, parent] : poses_->parents_first())
    movers_[link] =
        poses_->last_change(link) > settled_ ? link : (parent == nobody ? nobody : movers_[parent]);
}

}  // namespace fringe::detail
