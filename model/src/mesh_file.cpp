#include "fringe/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <span>
#include <string>
#include <string_view>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "fringe/error.hpp"
#include "obj_indices.hpp"
#include "ply_completeness.hpp"

namespace fringe {
namespace {

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension;
}

void require_readable(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 3> known{".stl", ".obj", ".ply"};
  if (std::find(known.begin(), known.end(), lower_case_extension(path)) == known.end())
    throw InputError("a mesh file must be .stl, .obj or .ply");
  if (!std::filesystem::is_regular_file(path))
    throw InputError(fmt::format("the mesh file {} does not exist", path.string()));
}

/// The vertices of the face with the given number, checked: a damaged file can name vertices that do not
/// exist, or hold numbers that are none.
std::vector<Eigen::Vector3d> face_vertices(const aiMesh& mesh, unsigned number) {
  const aiFace& face = mesh.mFaces[number];
  std::vector<Eigen::Vector3d> vertices;
  for (const unsigned index : std::span(face.mIndices, face.mNumIndices)) {
    if (index >= mesh.mNumVertices)
      throw InputError(fmt::format("face {} names vertex {} of {}", number, index, mesh.mNumVertices));
    const aiVector3D& vertex = mesh.mVertices[index];
    vertices.emplace_back(vertex.x, vertex.y, vertex.z);
    if (!vertices.back().allFinite())
      throw InputError(fmt::format("vertex {} of face {} is not finite", vertices.size() - 1, number));
  }
  return vertices;
}

void append_fans(std::vector<Triangle>& triangles, const aiMesh& mesh) {
  for (unsigned number = 0; number < mesh.mNumFaces; ++number) {
    const std::vector<Eigen::Vector3d> vertices = face_vertices(mesh, number);
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i)
      triangles.push_back({vertices[0], vertices[i], vertices[i + 1]});
  }
}

}  // namespace

std::vector<Triangle> read_mesh_file(const std::filesystem::path& path) {
  require_readable(path);
  std::vector<Triangle> triangles;
  try {
    if (lower_case_extension(path) == ".ply")
      detail::require_complete_ply(path);
    else if (lower_case_extension(path) == ".obj")
      detail::require_obj_indices(path);
    Assimp::Importer importer;
    // No post-processing: it would join, reorder or re-triangulate.
    const aiScene* scene = importer.ReadFile(path.string(), 0);
    if (scene == nullptr)
      throw InputError(importer.GetErrorString());
    for (const aiMesh* mesh : std::span(scene->mMeshes, scene->mNumMeshes))
      append_fans(triangles, *mesh);
  } catch (const std::exception& error) {
    throw InputError(fmt::format("the mesh file {} cannot be read: {}", path.string(), error.what()));
  }
  if (triangles.empty())
    throw InputError(fmt::format("the mesh file {} has no faces", path.string()));
  return triangles;
}

}  // namespace fringe
