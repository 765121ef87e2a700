#include "fringe/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "io/input_file.hpp"
#include "io/mesh_formats.hpp"

namespace fringe {
namespace {

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension;
}

using Reader = detail::MeshContent (*)(std::string_view);

Reader reader_for(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  if (extension == ".stl")
    return detail::read_stl;
  if (extension == ".obj")
    return detail::read_obj;
  if (extension == ".ply")
    return detail::read_ply;
  throw InputError(
      "a mesh file must be .stl, .obj or .ply; `fringe import` makes scenes of .dae, .3mf, .step and .gltf");
}

}  // namespace

std::vector<Triangle> read_mesh_file(const std::filesystem::path& path) {
  return detail::read_mesh_content(path).triangles;
}

namespace detail {

MeshContent read_mesh_content(const std::filesystem::path& path) {
  const Reader reader = reader_for(path);
  if (!is_file(path))
    throw InputError(fmt::format("the mesh file {} does not exist", path.string()));
  MeshContent mesh;
  try {
    const std::string content = file_content(path);
    require_content(content);
    mesh = reader(content);
  } catch (const InputError& error) {
    throw InputError(fmt::format("the mesh file {} cannot be read: {}", path.string(), error.what()));
  }
  if (mesh.triangles.empty())
    throw InputError(fmt::format("the mesh file {} has no faces", path.string()));
  return mesh;
}

}  // namespace detail
}  // namespace fringe
