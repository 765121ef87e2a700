#include "import/formats.hpp"

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
#include <tiny_gltf.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangle.hpp"
#include "import/link_tree.hpp"

namespace fringe::cli {
namespace {

/// The bytes of one accessor, whose bounds were checked: element i begins at data + i·stride.
struct Elements {
  const unsigned char* data;
  std::size_t stride;
  std::size_t count;
};

/// Locates an accessor's elements; throws InputError unless they are within their buffer.
Elements elements(const tinygltf::Model& model, int number) {
  const auto refuse = [number](const char* reason) {
    throw InputError(fmt::format("accessor {}: {}", number, reason));
  };
  if (number < 0 || static_cast<std::size_t>(number) >= model.accessors.size())
    refuse("does not exist");
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(number)];
  if (accessor.sparse.isSparse)
    refuse("is sparse, which is not read");
  if (accessor.bufferView < 0 || static_cast<std::size_t>(accessor.bufferView) >= model.bufferViews.size())
    refuse("has no buffer view");
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
    refuse("has no buffer");
  const std::vector<unsigned char>& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  const int component = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  const int stride = accessor.ByteStride(view);
  if (component <= 0 || components <= 0 || stride <= 0)
    refuse("has a type that does not exist");
  const auto size = static_cast<std::size_t>(component) * static_cast<std::size_t>(components);
  const auto step = static_cast<std::size_t>(stride);
  if (accessor.count == 0)
    return {nullptr, step, 0};
  // Each condition is tested separately, since sums could overflow.
  const bool fits = view.byteOffset <= bytes.size() && view.byteLength <= bytes.size() - view.byteOffset &&
                    accessor.byteOffset <= view.byteLength && size <= view.byteLength - accessor.byteOffset &&
                    (accessor.count - 1) <= (view.byteLength - accessor.byteOffset - size) / step;
  if (!fits)
    refuse("reaches beyond its buffer");
  return {bytes.data() + view.byteOffset + accessor.byteOffset, step, accessor.count};
}

template <typename Number>
Number number_at(const unsigned char* data) {
  Number number;
  std::memcpy(&number, data, sizeof number);
  return number;
}

std::vector<Eigen::Vector3d> positions(const tinygltf::Model& model, int number) {
  const Elements found = elements(model, number);
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(number)];
  if (accessor.type != TINYGLTF_TYPE_VEC3 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
    throw InputError(fmt::format("accessor {}: positions must be vectors of three floats", number));
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < found.count; ++i) {
    const unsigned char* data = found.data + i * found.stride;
    points.emplace_back(number_at<float>(data), number_at<float>(data + sizeof(float)),
                        number_at<float>(data + 2 * sizeof(float)));
    if (!points.back().allFinite())
      throw InputError(fmt::format("accessor {}: vertex {} is not finite", number, i));
  }
  return points;
}

/// Returns the order of the vertices: that of the indices, or all vertices in turn if there are none (number
/// −1).
std::vector<std::size_t> indices(const tinygltf::Model& model, int number, std::size_t vertices) {
  std::vector<std::size_t> result;
  if (number == -1) {
    for (std::size_t i = 0; i < vertices; ++i)
      result.push_back(i);
    return result;
  }
  const Elements found = elements(model, number);
  const int type = model.accessors[static_cast<std::size_t>(number)].componentType;
  for (std::size_t i = 0; i < found.count; ++i) {
    const unsigned char* data = found.data + i * found.stride;
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
      result.push_back(*data);
    else if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
      result.push_back(number_at<std::uint16_t>(data));
    else if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
      result.push_back(number_at<std::uint32_t>(data));
    else
      throw InputError(fmt::format("accessor {}: indices must be whole numbers without a sign", number));
    if (result.back() >= vertices)
      throw InputError(fmt::format("accessor {}: names vertex {} of {}", number, result.back(), vertices));
  }
  return result;
}

/// Appends the triangles of a primitive; ignores points and lines.
void append(std::vector<Triangle>& triangles, const tinygltf::Model& model,
            const tinygltf::Primitive& primitive) {
  // A primitive without a mode consists of triangles.
  const int mode = primitive.mode == -1 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN)
    return;
  if (!primitive.targets.empty())
    throw InputError("has morph targets, which are not read");
  const auto attribute = primitive.attributes.find("POSITION");
  if (attribute == primitive.attributes.end())
    throw InputError("has no positions");
  const std::vector<Eigen::Vector3d> points = positions(model, attribute->second);
  const std::vector<std::size_t> order = indices(model, primitive.indices, points.size());
  if (mode == TINYGLTF_MODE_TRIANGLES && order.size() % 3 != 0)
    throw InputError("the number of its vertices is not one of triangles");
  const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
  for (std::size_t i = 0; i + 2 < order.size(); i += step) {
    // In a strip every other triangle has reversed orientation; in a fan all triangles share the first
    // vertex.
    const bool turned = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
    const std::size_t first = mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i;
    const std::size_t second = turned ? i + 2 : i + 1;
    const std::size_t third = turned ? i + 1 : i + 2;
    triangles.push_back({points[order[first]], points[order[second]], points[order[third]]});
  }
}

}  // namespace

std::vector<Triangle> gltf_triangles(const tinygltf::Model& model, int mesh) {
  if (mesh < 0 || static_cast<std::size_t>(mesh) >= model.meshes.size())
    throw InputError(fmt::format("mesh {}: does not exist", mesh));
  std::vector<Triangle> triangles;
  try {
    for (const tinygltf::Primitive& primitive : model.meshes[static_cast<std::size_t>(mesh)].primitives)
      append(triangles, model, primitive);
  } catch (const InputError& error) {
    throw InputError(fmt::format("mesh {}: {}", mesh, error.what()));
  }
  return triangles;
}

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
