#pragma once

#include <vector>

#include "bem/jacobi_basis.hpp"
#include "reduced/node_kernels.hpp"

namespace fringe::detail {

/// The most points of a rule along one direction of a face.
constexpr int most_node_points = most_points;

/// A Gauss rule on [−1, 1] in single precision.
struct StoredRule {
  int points;
  std::vector<float> nodes;
  std::vector<float> weights;
  std::vector<float> values;

  NodeRule view() const { return {points, nodes.data(), weights.data(), values.data()}; }
};

/// The rule of 1 to most_node_points points, made with all others when it is first asked for.
const StoredRule& stored_rule(EdgeKind edge, int points);

}  // namespace fringe::detail
