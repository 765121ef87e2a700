#include "geometry/link_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/error.hpp"
#include "fringe/joint.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene.hpp"

namespace fringe {
namespace {

const Joint* find_joint(const std::vector<Link>& links, std::string_view name) {
  const auto found = std::find_if(links.begin(), links.end(), [name](const Link& link) {
    return link.joint && link.joint->name == name;
  });
  return found == links.end() ? nullptr : &*found->joint;
}

/// Returns the names of the joints that can be set.
std::vector<std::string> choices(const std::vector<Link>& links) {
  std::vector<std::string> names;
  for (const Link& link : links)
    if (link.joint && !link.joint->mimic)
      names.push_back(link.joint->name);
  return names;
}

/// Returns a joint's position, through all joints that it follows.
double position_of(const std::vector<Link>& links, const Joint& joint) {
  double multiplier = 1, offset = 0;
  const Joint* leader = &joint;
  for (std::size_t steps = 0; leader->mimic; ++steps) {
    if (steps > links.size())
      throw InputError(fmt::format("joint \"{}\": mimics itself", joint.name));
    offset += multiplier * leader->mimic->offset;
    multiplier *= leader->mimic->multiplier;
    const std::string& name = leader->mimic->joint;
    leader = find_joint(links, name);
    if (leader == nullptr)
      throw InputError(fmt::format(R"(joint "{}": mimics "{}", which does not exist)", joint.name, name));
  }
  const double position = offset + multiplier * leader->position;
  if (!std::isfinite(position))
    throw InputError(fmt::format("joint \"{}\": its position must be finite", joint.name));
  return position;
}

}  // namespace

Eigen::Isometry3d pose_at(const Joint& joint, double position) {
  const Eigen::Vector3d axis = (joint.axis / joint.axis.cwiseAbs().maxCoeff()).normalized();
  Eigen::Isometry3d pose = joint.rest;
  if (joint.kind == Joint::Kind::prismatic)
    pose.translation() += joint.rest.linear() * (position * axis);
  else if (position != 0)
    pose.linear() = joint.rest.linear() * Eigen::AngleAxisd(position, axis).toRotationMatrix();
  return pose;
}

void place_joints(std::vector<Link>& links) {
  for (Link& link : links)
    if (link.joint) {
      link.joint->position = position_of(links, *link.joint);
      link.pose = pose_at(*link.joint, link.joint->position);
    }
}

std::vector<LinkPose> joint_poses(const std::vector<Link>& links, std::string_view joint, double position) {
  const Joint* moved = find_joint(links, joint);
  if (moved == nullptr) {
    const std::vector<std::string> names = choices(links);
    throw InputError(fmt::format("there is no joint \"{}\"; {}", joint,
                                 names.empty() ? "the scene has none"
                                               : fmt::format("there are: {}", fmt::join(names, ", "))));
  }
  if (moved->mimic)
    throw InputError(fmt::format(R"(joint "{}" follows "{}")", joint, moved->mimic->joint));
  std::vector<Link> links_then = links;
  for (Link& link : links_then)
    if (link.joint && link.joint->name == joint)
      link.joint->position = position;
  place_joints(links_then);
  std::vector<LinkPose> poses;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Joint* leader = links[i].joint ? &*links[i].joint : nullptr;
    while (leader != nullptr && leader->mimic)
      leader = find_joint(links, leader->mimic->joint);
    if (leader == moved)
      poses.push_back({i, links_then[i].pose});
  }
  return poses;
}

}  // namespace fringe

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
