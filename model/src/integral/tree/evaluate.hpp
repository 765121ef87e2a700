#pragma once

#include "fringe/surface_tree.hpp"
#include "integral/tree/node.hpp"

namespace fringe::detail {

/// The accuracy required of an integral over a surface.
struct TreeAccuracy {
  double tolerance;  ///< largest error relative to the integral
  double allowance;  ///< additional error allowed, m
};

/// Implements SurfaceTree::integrate for valid arguments.
TreeIntegral evaluate(const SurfaceNodes& tree, const Rectangle& plate, const TreeAccuracy& accuracy,
                      FaceRule faces);

}  // namespace fringe::detail
