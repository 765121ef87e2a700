#include "import/formats.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <pugixml.hpp>

#include "fringe/error.hpp"
#include "import/link_tree.hpp"
#include "io/mesh_formats.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

/// Collects the warnings and errors of the library, which it writes to its log only.
class LibraryLog final : public Assimp::LogStream {
 public:
  explicit LibraryLog(std::vector<std::string>& lines) : lines_(lines) {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(this, Assimp::Logger::Warn | Assimp::Logger::Err);
  }
  LibraryLog(const LibraryLog&) = delete;
  LibraryLog& operator=(const LibraryLog&) = delete;
  ~LibraryLog() override {
    Assimp::DefaultLogger::get()->detachStream(this, Assimp::Logger::Warn | Assimp::Logger::Err);
    Assimp::DefaultLogger::kill();
  }

  void write(const char* message) override { lines_.push_back(one_line(message)); }

 private:
  std::vector<std::string>& lines_;
};

/// Removes what bounds no body, and may violate what the library expects of it.
void remove_unneeded(pugi::xml_node element) {
  static const std::set<std::string_view> unneeded{
      "bind_material",      "extra",           "instance_camera", "instance_light", "library_animation_clips",
      "library_animations", "library_cameras", "library_effects", "library_images", "library_lights",
      "library_materials"};
  for (pugi::xml_node child = element.first_child(); child;) {
    const pugi::xml_node next = child.next_sibling();
    if (unneeded.contains(child.name()))
      element.remove_child(child);
    else
      remove_unneeded(child);
    child = next;
  }
}

/// Returns the text of a COLLADA file in UTF-8 without materials, lights, cameras and animations.
std::string simplified(const std::string& content) {
  pugi::xml_document document;
  if (const pugi::xml_parse_result parsed = document.load_buffer(content.data(), content.size()); !parsed)
    throw InputError(fmt::format("is damaged XML: {}", parsed.description()));
  remove_unneeded(document);
  std::ostringstream text;
  document.save(text, "", pugi::format_raw);
  return text.str();
}

Eigen::Affine3d affine_of(const aiMatrix4x4& matrix) {
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  for (unsigned row = 0; row < 3; ++row)
    for (unsigned column = 0; column < 4; ++column)
      affine.matrix()(row, column) = matrix[row][column];
  if (!affine.matrix().allFinite())
    throw InputError("its place must be finite");
  return affine;
}

/// Appends the triangles of a mesh; ignores points and lines. Throws InputError for what is no surface.
void append(detail::MeshContent& content, const aiMesh& mesh) {
  if (mesh.HasBones())
    throw InputError("has a skin, which is not read");
  if (mesh.mNumAnimMeshes > 0)
    throw InputError("has morph targets, which are not read");
  std::vector<Eigen::Vector3d> outline;
  for (unsigned face = 0; face < mesh.mNumFaces; ++face) {
    const aiFace& corners = mesh.mFaces[face];
    if (corners.mNumIndices < 3)
      continue;
    outline.clear();
    for (unsigned corner = 0; corner < corners.mNumIndices; ++corner) {
      const unsigned index = corners.mIndices[corner];
      if (index >= mesh.mNumVertices)
        throw InputError(fmt::format("face {} names vertex {} of {}", face, index, mesh.mNumVertices));
      const aiVector3D& vertex = mesh.mVertices[index];
      outline.emplace_back(vertex.x, vertex.y, vertex.z);
      if (!outline.back().allFinite())
        throw InputError(fmt::format("vertex {} is not finite", index));
    }
    detail::append_face(content.triangles, outline, content.defects);
  }
}

/// Reads one file.
class ColladaReader {
 public:
  /// `upright`: what is up in the file becomes z.
  ColladaReader(const fs::path& path, const std::string& content, bool upright,
                std::vector<std::string>& warnings)
      : path_(path), warnings_(warnings) {
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, !upright);
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
    std::vector<std::string> lines;
    {
      const std::string text = simplified(content);
      const LibraryLog log(lines);
      // The library would divide faces otherwise than the readers of meshes do.
      scene_ = importer_.ReadFileFromMemory(text.data(), text.size(), aiProcess_ValidateDataStructure, "dae");
    }
    for (const std::string& line : lines) {
      // Geometry that the file refers to but does not contain would be missing in the scene.
      if (line.find("Unable to find geometry") != std::string::npos ||
          line.find("Unable to resolve reference") != std::string::npos)
        throw InputError(line);
      if (is_about_geometry(line))
        warnings.push_back(fmt::format("{}: {}", path.string(), line));
    }
    if (scene_ == nullptr)
      throw InputError(one_line(importer_.GetErrorString()));
    // The library makes a mesh of its own of the nodes where there is none.
    if ((scene_->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0 || scene_->mRootNode == nullptr)
      throw InputError("holds no triangles");
    if (upright)
      // The library turns what is up to y.
      root_.linear() =
          Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix().array().round();
  }

  Scene links() {
    add_node(*scene_->mRootNode, std::nullopt, 0);
    return tree_.take();
  }

 private:
  /// Returns whether a remark concerns the shape; textures, colours and cameras are not needed.
  static bool is_about_geometry(std::string_view line) {
    return line.find("polygon") != std::string_view::npos ||
           line.find("triangulat") != std::string_view::npos || line.find("meter") != std::string_view::npos;
  }

  /// Adds the link of a node, its meshes as one object, and its children. The materials of a node's mesh are
  /// one body, which they bound together.
  void add_node(const aiNode& node, std::optional<std::size_t> parent, std::size_t depth) {
    const std::string name = name_of(node, parent.has_value());
    const std::string what = fmt::format("node \"{}\"", name);
    if (depth > deepest)
      throw InputError(fmt::format("{}: is below more than {} others", what, deepest));
    std::size_t link = 0;
    try {
      const Eigen::Affine3d place = affine_of(node.mTransformation);
      link = tree_.add_link(name, parent, split(parent ? place : root_ * place));
      detail::MeshContent content;
      for (unsigned mesh = 0; mesh < node.mNumMeshes; ++mesh) {
        if (node.mMeshes[mesh] >= scene_->mNumMeshes)
          throw InputError(fmt::format("names mesh {} of {}", node.mMeshes[mesh], scene_->mNumMeshes));
        append(content, *scene_->mMeshes[node.mMeshes[mesh]]);
      }
      for (const std::string& remark : detail::remarks_on_faces(content.defects, 1))
        warnings_.push_back(fmt::format("{}: {}: {}", path_.string(), what, remark));
      tree_.add_object(tree_.name_of(link), link, std::move(content.triangles));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", what, error.what()));
    }
    for (unsigned child = 0; child < node.mNumChildren; ++child)
      add_node(*node.mChildren[child], link, depth + 1);
  }

  std::string name_of(const aiNode& node, bool is_below) {
    ++nodes_;
    const std::string_view name = node.mName.C_Str();
    if (!is_below)
      return path_.stem().string();
    if (name.empty() || name.starts_with("$ColladaAutoName$"))
      return fmt::format("node {}", nodes_ - 1);
    return std::string(name);
  }

  /// Limit of nesting, far above that of any model; nodes are read recursively, which takes space on the
  /// stack.
  static constexpr std::size_t deepest = 1000;

  const fs::path& path_;
  std::vector<std::string>& warnings_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
  Eigen::Affine3d root_ = Eigen::Affine3d::Identity();
  LinkTree tree_;
  std::size_t nodes_ = 0;
};

}  // namespace

Scene read_collada(const fs::path& path, const std::string& content, bool upright,
                   std::vector<std::string>& warnings) {
  return ColladaReader(path, content, upright, warnings).links();
}

}  // namespace fringe::cli
