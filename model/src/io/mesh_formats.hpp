#pragma once

#include <string_view>
#include <vector>

#include "fringe/triangle.hpp"

/// The formats of mesh files. Each reader returns the triangles of a file's content in their order, with
/// polygons divided into fans from their first vertex, and throws InputError for whatever violates the
/// format.
namespace fringe::detail {

/// Reads an STL file. It is binary, whatever its first bytes, if its length agrees with its count of
/// triangles, and text otherwise.
std::vector<Triangle> read_stl(std::string_view content);

/// Reads the vertices and faces of an OBJ file; skips groups, normals, materials and everything else.
std::vector<Triangle> read_obj(std::string_view content);

/// Reads the vertices' x, y, z and the faces' vertex lists of a PLY file; skips everything else.
std::vector<Triangle> read_ply(std::string_view content);

}  // namespace fringe::detail
