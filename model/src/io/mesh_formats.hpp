#pragma once

#include <string_view>
#include <vector>

#include "fringe/triangle.hpp"

/// The formats of mesh files. Each reader gives the triangles of a file's bytes in their order, polygons as
/// fans from their first vertex, and throws InputError for whatever is not as the format says.
namespace fringe::detail {

/// A file as long as its count of triangles says is one of bytes, whatever it begins with.
std::vector<Triangle> read_stl(std::string_view content);

/// Vertices and faces; groups, normals, materials and whatever else there may be are left out.
std::vector<Triangle> read_obj(std::string_view content);

/// The vertices' x, y, z and the faces' lists of vertices; all else is left out.
std::vector<Triangle> read_ply(std::string_view content);

}  // namespace fringe::detail
