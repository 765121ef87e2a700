#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "fringe/triangle.hpp"
#include "geometry/polygon.hpp"

/// The formats of mesh files. Each reader returns the triangles of a file's faces in their order, and throws
/// InputError for whatever violates the format.
namespace fringe::detail {

/// The triangles of a file, and what is remarkable about its faces.
struct MeshContent {
  std::vector<Triangle> triangles;
  FaceDefects defects;
};

/// Reads an STL file. It is binary, whatever its first bytes, if its length agrees with its count of
/// triangles, and text otherwise.
MeshContent read_stl(std::string_view content);

/// Reads the vertices and faces of an OBJ file; skips groups, normals, materials and everything else.
MeshContent read_obj(std::string_view content);

/// The faces of an OBJ file that belong to an object or a group of one name.
struct NamedMesh {
  std::string name;  ///< empty for faces before any name
  MeshContent mesh;
};

/// Reads an OBJ file as its objects and groups, in the order of their names; some may have no
/// faces.
std::vector<NamedMesh> read_obj_bodies(std::string_view content);

/// Reads the vertices' x, y, z and the faces' vertex lists of a PLY file; skips everything else.
MeshContent read_ply(std::string_view content);

/// Reads an STL, OBJ or PLY file, as read_mesh_file does.
MeshContent read_mesh_content(const std::filesystem::path& path);

}  // namespace fringe::detail
