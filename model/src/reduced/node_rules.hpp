#pragma once

#include <vector>

#include "bem/jacobi_basis.hpp"
#include "reduced/node_kernels.hpp"

namespace fringe::detail {

/// Largest number of points of a rule along one direction of a face.
constexpr int most_node_points = most_points;

/// A Gauss rule on [−1, 1] in single precision.
struct StoredRule {
  int points;
  std::vector<float> nodes;
  std::vector<float> weights;
  std::vector<float> values;

  NodeRule view() const { return {points, nodes.data(), weights.data(), values.data()}; }
};

/// Returns the rule of 1 to most_node_points points. The first call makes all of them.
const StoredRule& stored_rule(EdgeKind edge, int points);

}  // namespace fringe::detail
