#pragma once

namespace fringe::detail {

struct GaussNode {
  double position;  ///< in (0, 1)
  double weight;    ///< the weights of a rule add up to 1
};

}  // namespace fringe::detail
