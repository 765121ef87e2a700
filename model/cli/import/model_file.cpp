#include "import/model_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <assimp/DefaultIOSystem.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/ZipArchiveIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <minizip/unzip.h>

#include "fringe/error.hpp"
#include "fringe/mesh_file.hpp"
#include "import/link_tree.hpp"

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

/// Returns the text of the model in a 3MF file, which is an archive.
std::string model_in_3mf(const fs::path& path) {
  const std::unique_ptr<void, int (*)(void*)> archive(unzOpen(path.c_str()), unzClose);
  std::array<char, 1024> name{};
  if (!archive)
    throw InputError("is not an archive");
  for (int found = unzGoToFirstFile(archive.get()); found == UNZ_OK; found = unzGoToNextFile(archive.get())) {
    unz_file_info about{};
    if (unzGetCurrentFileInfo(archive.get(), &about, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) !=
        UNZ_OK)
      break;
    if (!std::string_view(name.data()).ends_with(".model"))
      continue;
    // The unit is at the beginning.
    constexpr unsigned enough = 65536;
    std::string text(std::min<std::size_t>(about.uncompressed_size, enough), ' ');
    const bool read = unzOpenCurrentFile(archive.get()) == UNZ_OK &&
                      unzReadCurrentFile(archive.get(), text.data(), static_cast<unsigned>(text.size())) ==
                          static_cast<int>(text.size());
    unzCloseCurrentFile(archive.get());
    if (!read)
      throw InputError("its model cannot be read");
    return text;
  }
  throw InputError("holds no model");
}

/// Returns the length of the unit of a 3MF file in metres; the library ignores it. Throws InputError for a
/// unit that the format does not have.
double unit_of_3mf(const fs::path& path) {
  const std::string text = model_in_3mf(path);
  const std::size_t begin = text.find("<model");
  const std::string_view element =
      std::string_view(text).substr(std::min(begin, text.size()), text.find('>', begin) - begin);
  const std::size_t unit = element.find(" unit=");
  if (unit == std::string_view::npos)
    return 1e-3;
  constexpr std::size_t before = 7;  // The space, the key, the sign of equality and the quotation mark.
  const std::string_view rest = element.substr(std::min(unit + before, element.size()));
  const std::string_view name = rest.substr(0, rest.find_first_of("\"'"));
  constexpr std::array<std::pair<std::string_view, double>, 6> units{{{"micron", 1e-6},
                                                                      {"millimeter", 1e-3},
                                                                      {"centimeter", 1e-2},
                                                                      {"inch", 0.0254},
                                                                      {"foot", 0.3048},
                                                                      {"meter", 1}}};
  for (const auto& [known, length] : units)
    if (name == known)
      return length;
  throw InputError(fmt::format("has the unit \"{}\", which is none of 3MF", name));
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
void append(std::vector<Triangle>& triangles, const aiMesh& mesh) {
  if (mesh.HasBones())
    throw InputError("has a skin, which is not read");
  if (mesh.mNumAnimMeshes > 0)
    throw InputError("has morph targets, which are not read");
  for (unsigned face = 0; face < mesh.mNumFaces; ++face) {
    const aiFace& corners = mesh.mFaces[face];
    if (corners.mNumIndices < 3)
      continue;
    if (corners.mNumIndices > 3)
      throw InputError(fmt::format("face {} cannot be divided into triangles", face));
    Triangle triangle;
    for (unsigned corner = 0; corner < 3; ++corner) {
      const unsigned index = corners.mIndices[corner];
      if (index >= mesh.mNumVertices)
        throw InputError(fmt::format("face {} names vertex {} of {}", face, index, mesh.mNumVertices));
      const aiVector3D& vertex = mesh.mVertices[index];
      triangle[corner] = Eigen::Vector3d(vertex.x, vertex.y, vertex.z);
      if (!triangle[corner].allFinite())
        throw InputError(fmt::format("vertex {} is not finite", index));
    }
    triangles.push_back(triangle);
  }
}

/// Reads one file.
class Reader {
 public:
  /// `upright`: what is up in the file becomes z.
  Reader(const fs::path& path, bool upright, std::vector<std::string>& warnings)
      : path_(path), kind_(extension_of(path)) {
    if (!fs::is_regular_file(path))
      throw InputError("the file does not exist or is not a file");
    // The library passes over what it does not understand in OBJ and invents vertices; this reader does not.
    if (kind_ == ".obj")
      expected_ = read_mesh_file(path).size();
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, !upright);
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
    std::vector<std::string> lines;
    {
      const LibraryLog log(lines);
      scene_ = importer_.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_ValidateDataStructure);
    }
    if (scene_ == nullptr)
      throw InputError(one_line(importer_.GetErrorString()));
    if ((scene_->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0 || scene_->mRootNode == nullptr)
      throw InputError("was read in part only");
    for (const std::string& line : lines) {
      // Geometry that the file refers to but does not contain would be missing in the scene.
      if (line.find("Unable to find geometry") != std::string::npos ||
          line.find("Unable to resolve reference") != std::string::npos)
        throw InputError(line);
      if (is_about_geometry(line))
        warnings.push_back(fmt::format("{}: {}", path.string(), line));
    }
    if (kind_ == ".dae" && upright)
      // The library turns what is up to y.
      root_.linear() =
          Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix().array().round();
    if (kind_ == ".3mf")
      root_.linear() *= unit_of_3mf(path);
  }

  Scene links() {
    add_node(*scene_->mRootNode, std::nullopt, 0);
    check_count();
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
      std::vector<Triangle> triangles;
      for (unsigned mesh = 0; mesh < node.mNumMeshes; ++mesh) {
        if (node.mMeshes[mesh] >= scene_->mNumMeshes)
          throw InputError(fmt::format("names mesh {} of {}", node.mMeshes[mesh], scene_->mNumMeshes));
        append(triangles, *scene_->mMeshes[node.mMeshes[mesh]]);
      }
      count_ += triangles.size();
      tree_.add_object(tree_.name_of(link), link, std::move(triangles));
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

  void check_count() const {
    if (expected_ && *expected_ != count_)
      throw InputError(fmt::format("holds {} triangles, of which the library reads {}", *expected_, count_));
  }

  /// Limit of nesting, far above that of any model; nodes are read recursively, which takes space on the
  /// stack.
  static constexpr std::size_t deepest = 1000;

  const fs::path& path_;
  std::string kind_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
  std::optional<std::size_t> expected_;
  Eigen::Affine3d root_ = Eigen::Affine3d::Identity();
  LinkTree tree_;
  std::size_t nodes_ = 0;
  std::size_t count_ = 0;
};

/// Puts the file in front of messages.
template <typename Action>
auto of_file(const fs::path& path, const Action& action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace

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
  return of_file(path, [&] { return Reader(path, true, warnings).links(); });
}

std::vector<Triangle> read_model_triangles(const fs::path& path, std::vector<std::string>& warnings) {
  return of_file(path, [&] { return triangles_in_world(Reader(path, false, warnings).links()); });
}

}  // namespace fringe::cli
