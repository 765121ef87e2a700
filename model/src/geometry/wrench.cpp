#include "geometry/wrench.hpp"

namespace fringe::detail {

using Eigen::Vector3d;

Wrench in_outer_frame(const Wrench& wrench, const Eigen::Isometry3d& pose) {
  const Vector3d force = pose.linear() * wrench.force;
  return {force, pose.linear() * wrench.torque + pose.translation().cross(force)};
}

namespace {

/// Calls act(pair, sign) for the pairs of which one body moves with a link and the other does not.
template <typename Action>
void for_pairs_of_link(const LinkPoses& poses, std::span<const PairWrench> pairs, std::size_t link,
                       const Action& act) {
  const auto moves_with_link = [&](std::optional<std::size_t> body) {
    while (body && *body != link)
      body = poses.links()[*body].parent;
    return body.has_value();
  };
  for (const PairWrench& pair : pairs)
    if (const bool moves = moves_with_link(pair.link); moves != moves_with_link(pair.other))
      act(pair, moves ? 1.0 : -1.0);
}

}  // namespace

std::vector<LinkDerivatives> derivatives_by_link(const LinkPoses& poses, std::span<const PairWrench> pairs) {
  const std::vector<Link>& links = poses.links();
  std::vector<LinkDerivatives> result;
  for (std::size_t k = 0; k < links.size(); ++k) {
    Wrench sum;
    for_pairs_of_link(poses, pairs, k,
                      [&](const PairWrench& pair, double sign) { sum += sign * pair.wrench; });
    LinkDerivatives& derivatives = result.emplace_back(LinkDerivatives{links[k].name, {}, {}});
    derivatives.change << sum.force, sum.torque - poses.world_pose(k).translation().cross(sum.force);
  }
  return result;
}

std::vector<double> moments_by_link(const LinkPoses& poses, std::span<const PairWrench> pairs) {
  std::vector<double> result(poses.links().size(), 0.0);
  for (std::size_t k = 0; k < result.size(); ++k)
    for_pairs_of_link(poses, pairs, k, [&](const PairWrench& pair, double) {
      if (pair.smaller)
        result[k] +=
            pair.wrench.force.norm() *
            ((pair.smaller->centre - poses.world_pose(k).translation()).norm() + pair.smaller->radius);
    });
  return result;
}

}  // namespace fringe::detail
