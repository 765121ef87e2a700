#include "geometry/link_motion.hpp"

#include <algorithm>

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

LinkMotion::LinkMotion(const std::vector<Link>& links)
    : links_(links), world_poses_(fringe::world_poses(links)), moved_(links.size()),
      movers_(links.size(), nobody) {
  std::vector<std::pair<std::size_t, std::size_t>> by_depth;
  for (std::size_t link = 0; link < links.size(); ++link)
    by_depth.emplace_back(depth(links, link), link);
  for (std::size_t link = 0; link < links.size(); ++link)
    indices_.emplace(links[link].name, link);
  std::sort(by_depth.begin(), by_depth.end());
  for (const auto& [above, link] : by_depth)
    parents_first_.push_back(link);
}

void LinkMotion::set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
  const auto known = indices_.find(std::string(link));
  // For an unknown name, find_link throws the error.
  const std::size_t index = known == indices_.end() ? find_link(links_, link) : known->second;
  links_[index].pose = pose;
  moved_[index] = true;
}

void LinkMotion::update() {
  for (const std::size_t link : parents_first_) {
    const std::optional<std::size_t> parent = links_[link].parent;
    movers_[link] = moved_[link] ? link : mover(parent);
    if (movers_[link] != nobody)
      world_poses_[link] = world_pose(parent) * links_[link].pose;
  }
}

void LinkMotion::settle() {
  std::fill(moved_.begin(), moved_.end(), false);
}

}  // namespace fringe::detail
