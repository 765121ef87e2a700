#include "import_command.hpp"

#include <algorithm>
#include <cctype>
#include <variant>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "gltf.hpp"
#include "scene_file.hpp"
#include "urdf.hpp"

namespace fringe::cli {
namespace {

Scene read(const ImportRequest& request) {
  std::string extension = request.source.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  if (extension == ".urdf")
    return read_urdf(request.source, parse_urdf_geometry(request.geometry), request.package_paths);
  if (extension != ".gltf" && extension != ".glb")
    throw InputError(fmt::format("{}: must end in .urdf, .gltf or .glb", request.source.string()));
  if (request.about_urdf)
    throw InputError("--geometry and --package-path are options for URDF");
  return read_gltf(request.source);
}

}  // namespace

std::string import_scene(const ImportRequest& request) {
  const Scene scene = read(request);
  const auto meshes = std::count_if(scene.objects.begin(), scene.objects.end(), [](const Object& object) {
    return std::holds_alternative<Mesh>(object.shape);
  });
  write_scene_file(scene, request.target, request.source.filename().string());
  return fmt::format("{}: {} links, {} objects, {} of them meshes", request.target.string(),
                     scene.links.size(), scene.objects.size(), meshes);
}

}  // namespace fringe::cli
