#include "geometry/wrench.hpp"

namespace fringe::detail {

using Eigen::Vector3d;

Wrench in_outer_frame(const Wrench& wrench, const Eigen::Isometry3d& pose) {
  const Vector3d force = pose.linear() * wrench.force;
  return {force, pose.linear() * wrench.torque + pose.translation().cross(force)};
}

std::vector<LinkDerivatives> derivatives_by_link(const LinkPoses& poses, std::span<const PairWrench> pairs) {
  const std::vector<Link>& links = poses.links();
  const auto moves_with = [&](std::optional<std::size_t> body, std::size_t link) {
    while (body && *body != link)
      body = links[*body].parent;
    return body.has_value();
  };
  std::vector<LinkDerivatives> result;
  for (std::size_t k = 0; k < links.size(); ++k) {
    Wrench sum;
    for (const auto& [link, other, wrench] : pairs)
      if (const bool moves = moves_with(link, k); moves != moves_with(other, k))
        sum += (moves ? 1.0 : -1.0) * wrench;
    LinkDerivatives& derivatives = result.emplace_back(LinkDerivatives{links[k].name, {}, {}});
    derivatives.change << sum.force, sum.torque - poses.world_pose(k).translation().cross(sum.force);
  }
  return result;
}

}  // namespace fringe::detail
