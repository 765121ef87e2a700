#pragma once

#include <tiny_gltf.h>

#include <vector>

#include "fringe/triangle.hpp"

namespace fringe::cli {

/// Returns the triangles of a model's mesh in the order of its primitives; points and lines are ignored.
/// Throws InputError with the element and the reason, without the file.
std::vector<Triangle> gltf_triangles(const tinygltf::Model& model, int mesh);

}  // namespace fringe::cli
