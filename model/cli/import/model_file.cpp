
#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "import/formats.hpp"
#include "import/link_tree.hpp"
#include "io/input_file.hpp"
#include "io/mesh_formats.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Reads the objects and groups of an OBJ file as links below one of the file.
Scene read_obj_model(const fs::path& path, const std::string& content, std::vector<std::string>& warnings) {
  LinkTree tree;
  const std::size_t root = tree.add_link(path.stem().string(), std::nullopt, {});
  for (detail::NamedMesh& body : detail::read_obj_bodies(content)) {
    if (body.mesh.triangles.empty())
      continue;
    const std::size_t link = body.name.empty() ? root : tree.add_link(body.name, root, {});
    for (const std::string& remark : detail::remarks_on_faces(body.mesh.defects, 1))
      warnings.push_back(fmt::format("{}: \"{}\": {}", path.string(), tree.name_of(link), remark));
    tree.add_object(tree.name_of(link), link, std::move(body.mesh.triangles));
  }
  return tree.take();
}

/// Reads a model. What is up in COLLADA becomes z if it is to be `upright`.
Scene read(const fs::path& path, bool upright, std::vector<std::string>& warnings) {
  try {
    std::string content = content_of(path);
    const std::string extension = extension_of(path);
    if (extension == ".3mf")
      return read_three_mf(path, std::move(content), warnings);
    if (extension == ".obj")
      return read_obj_model(path, content, warnings);
    return read_collada(path, content, upright, warnings);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace

std::string content_of(const fs::path& path) {
  if (!detail::is_file(path))
    throw InputError("the file does not exist or is not a file");
  std::string content = detail::file_content(path);
  detail::require_content(content);
  return content;
}

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension;
}

bool is_model_file(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".dae" || extension == ".obj" || extension == ".3mf";
}

Scene read_model(const fs::path& path, std::vector<std::string>& warnings) {
  return read(path, true, warnings);
}

std::vector<Triangle> read_model_triangles(const fs::path& path, std::vector<std::string>& warnings) {
  return triangles_in_world(read(path, false, warnings));
}

}  // namespace fringe::cli
