#pragma once

#include "fringe/bounding_volume.hpp"

namespace fringe::detail {

/// Tests boxes for overlap as overlap() does, if their axes are orthonormal only to a tenth of `margin`.
/// False means that they are apart by more than the margin times the sum of all lengths.
bool overlap_within(const OrientedBox& a, const OrientedBox& b, double margin);

}  // namespace fringe::detail
