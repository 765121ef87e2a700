#pragma once

#include "fringe/bounding_volume.hpp"

namespace fringe::detail {

/// As overlap(), for boxes whose axes are orthonormal only to a tenth of `margin`: an answer of "no" means
/// that they are apart by more than the margin times all lengths together.
bool overlap_within(const OrientedBox& a, const OrientedBox& b, double margin);

}  // namespace fringe::detail
