#include "fringe/joint.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/error.hpp"
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
