#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// The triangles of a surface divided towards its sharp edges, so that one density on each would miss about
/// the part `missing` of the energy, evenly spread over all; but no more triangles than `most`, if there were
/// less (model/BOUNDARY_ELEMENTS.md, section 9).
std::vector<Triangle> graded_triangles(std::span<const Triangle> triangles, double missing, std::size_t most);

}  // namespace fringe::detail
