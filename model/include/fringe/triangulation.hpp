#pragma once

#include <vector>

#include "fringe/shape.hpp"
#include "fringe/triangle.hpp"

namespace fringe {

/// Computes the triangles of a shape in its own frame: the vertices and the order that geometries/SCENE.md
/// fixes.
std::vector<Triangle> triangulate(const Shape& shape);

}  // namespace fringe
