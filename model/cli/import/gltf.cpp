#include "import/gltf.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "import/gltf_triangles.hpp"
#include "import/link_tree.hpp"
#include "import/model_file.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Returns the extensions that a model needs. The library does not get to them where data have another form.
std::vector<std::string> needed_extensions(const std::string& content, bool is_binary) {
  // The text of a binary file follows five numbers of four bytes, of which the fourth is its length.
  constexpr std::size_t length_at = 12, text_at = 20;
  std::string_view text = content;
  if (is_binary && content.size() > text_at) {
    std::uint32_t length = 0;
    std::memcpy(&length, content.data() + length_at, sizeof length);
    text = text.substr(text_at, length);
  }
  const auto document = nlohmann::json::parse(text, nullptr, false);
  std::vector<std::string> needed;
  if (document.is_object() && document.contains("extensionsRequired"))
    for (const auto& name : document["extensionsRequired"])
      if (name.is_string())
        needed.push_back(name.get<std::string>());
  return needed;
}

/// Returns whether an extension is about looks only.
bool is_about_looks(std::string_view extension) {
  return extension.find("_materials_") != std::string_view::npos ||
         extension.find("_texture_") != std::string_view::npos ||
         extension.find("_lights_") != std::string_view::npos;
}

tinygltf::Model parse(const fs::path& path) {
  const std::string content = content_of(path);
  const bool is_binary = extension_of(path) == ".glb";
  for (const std::string& extension : needed_extensions(content, is_binary))
    if (!is_about_looks(extension))
      throw InputError(fmt::format("needs the extension {}, which is not read", extension));
  tinygltf::TinyGLTF loader;
  // Images are not needed.
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int,
                           const unsigned char*, int, void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string errors;
  std::string warnings;
  const bool read = is_binary ? loader.LoadBinaryFromFile(&model, &errors, &warnings, path.string())
                              : loader.LoadASCIIFromFile(&model, &errors, &warnings, path.string());
  if (!read || !errors.empty()) {
    std::replace(errors.begin(), errors.end(), '\n', ' ');
    throw InputError(errors.empty() ? "is not a model in glTF" : errors);
  }
  return model;
}

/// Splits a node's transformation into rotation, rest and translation.
NodePose pose_of(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) {
    const Eigen::Map<const Eigen::Matrix4d> matrix(node.matrix.data());
    Eigen::Affine3d affine = Eigen::Affine3d::Identity();
    affine.matrix().topRows<3>() = matrix.topRows<3>();
    return split(affine);
  }
  NodePose pose;
  if (node.translation.size() == 3)
    pose.translation = Eigen::Vector3d(node.translation.data());
  if (node.scale.size() == 3)
    pose.rest = Eigen::Vector3d(node.scale.data()).asDiagonal();
  if (node.rotation.size() == 4) {
    const Eigen::Quaterniond turn(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (!turn.coeffs().allFinite() || turn.coeffs().isZero(0))
      throw InputError("its rotation must not be zero");
    pose.rotation = pose_from_quaternion(turn, Eigen::Vector3d::Zero()).linear();
  }
  return pose;
}

class GltfReader {
 public:
  explicit GltfReader(const tinygltf::Model& model) : model_(model) {}

  Scene read() {
    if (model_.scenes.empty())
      throw InputError("holds no scene");
    const std::size_t chosen = model_.defaultScene < 0 ? 0 : static_cast<std::size_t>(model_.defaultScene);
    if (chosen >= model_.scenes.size())
      throw InputError(fmt::format("scene {}: does not exist", chosen));
    for (const int node : model_.scenes[chosen].nodes)
      add_node(node, std::nullopt, 0);
    return tree_.take();
  }

 private:
  /// Adds a node and its children.
  void add_node(int number, std::optional<std::size_t> parent, std::size_t depth) {
    const std::string what = fmt::format("node {}", number);
    if (number < 0 || static_cast<std::size_t>(number) >= model_.nodes.size())
      throw InputError(what + ": does not exist");
    if (!reached_.insert(number).second)
      throw InputError(what + ": is below two nodes, or below itself");
    if (depth > deepest)
      throw InputError(fmt::format("{}: is below more than {} others", what, deepest));
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(number)];
    std::size_t link = 0;
    try {
      if (node.skin != -1)
        throw InputError("has a skin, which is not read");
      link = tree_.add_link(node.name.empty() ? what : node.name, parent, pose_of(node));
      if (node.mesh != -1)
        tree_.add_object(tree_.name_of(link), link, gltf_triangles(model_, node.mesh));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", what, error.what()));
    }
    for (const int child : node.children)
      add_node(child, link, depth + 1);
  }

  /// Limit of nesting, far above that of any model; nodes are read recursively, which takes space on the
  /// stack.
  static constexpr std::size_t deepest = 1000;

  const tinygltf::Model& model_;
  LinkTree tree_;
  std::set<int> reached_;
};

}  // namespace

Scene read_gltf(const fs::path& path) {
  try {
    const tinygltf::Model model = parse(path);
    return GltfReader(model).read();
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace fringe::cli
