#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// Divides the triangles of a surface towards its sharp edges, until one density on each would miss about the
/// fraction `missing` of the energy, evenly spread over all. Stops when there are `most` triangles
/// (model/BOUNDARY_ELEMENTS.md, section 9).
std::vector<Triangle> graded_triangles(std::span<const Triangle> triangles, double missing, std::size_t most);

}  // namespace fringe::detail
