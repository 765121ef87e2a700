#include "reduced/node_rules.hpp"

namespace fringe::detail {
namespace {

StoredRule make_rule(EdgeKind edge, int points) {
  const DirectionRule& rule = whole_rule(edge, points);
  const auto row = static_cast<std::size_t>(whole_blocks(points));
  StoredRule stored{points, std::vector<float>(row, 0.0F),
                    std::vector<float>(most_reduced_functions * row, 0.0F),
                    std::vector<float>(static_cast<std::size_t>(points) * node_block, 0.0F)};
  for (std::size_t q = 0; q < static_cast<std::size_t>(points); ++q)
    stored.nodes[q] = static_cast<float>(rule.nodes[static_cast<Eigen::Index>(q)]);
  for (std::size_t k = 0; k < most_reduced_functions; ++k)
    for (std::size_t q = 0; q < static_cast<std::size_t>(points); ++q) {
      const auto weight =
          static_cast<float>(rule.weights(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(q)));
      stored.weights[k * row + q] = weight;
      stored.values[q * node_block + k] = weight;
    }
  return stored;
}

template <EdgeKind edge>
const StoredRule& stored_rule_of(int points) {
  static const std::vector<StoredRule> rules = [] {
    std::vector<StoredRule> made;
    for (int count = 1; count <= most_node_points; ++count)
      made.push_back(make_rule(edge, count));
    return made;
  }();
  return rules[static_cast<std::size_t>(points - 1)];
}

}  // namespace

const StoredRule& stored_rule(EdgeKind edge, int points) {
  return edge == EdgeKind::thin ? stored_rule_of<EdgeKind::thin>(points)
                                : stored_rule_of<EdgeKind::right_angle>(points);
}

}  // namespace fringe::detail
