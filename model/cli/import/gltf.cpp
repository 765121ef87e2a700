#include "gltf.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "gltf_triangles.hpp"
#include "unique_names.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

tinygltf::Model parse(const fs::path& path) {
  if (!fs::is_regular_file(path))
    throw InputError("the file does not exist or is not a file");
  tinygltf::TinyGLTF loader;
  // Images are not needed.
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int,
                           const unsigned char*, int, void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string errors;
  std::string warnings;
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const bool read = extension == ".glb" ? loader.LoadBinaryFromFile(&model, &errors, &warnings, path.string())
                                        : loader.LoadASCIIFromFile(&model, &errors, &warnings, path.string());
  if (!read || !errors.empty()) {
    std::replace(errors.begin(), errors.end(), '\n', ' ');
    throw InputError(errors.empty() ? "is not a model in glTF" : errors);
  }
  if (!model.extensionsRequired.empty())
    throw InputError(
        fmt::format("needs the extension {}, which is not read", model.extensionsRequired.front()));
  return model;
}

/// The pose p ↦ rotation·rest·p + translation, where `rest` is the scaling and shear that a rigid link cannot
/// have.
struct NodePose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d rest = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// Splits a node's transformation into rotation, rest and translation.
NodePose pose_of(const tinygltf::Node& node) {
  NodePose pose;
  if (node.matrix.size() == 16) {
    const Eigen::Map<const Eigen::Matrix4d> matrix(node.matrix.data());
    Eigen::Affine3d affine = Eigen::Affine3d::Identity();
    affine.matrix().topRows<3>() = matrix.topRows<3>();
    affine.computeRotationScaling(&pose.rotation, &pose.rest);
    pose.translation = affine.translation();
    return pose;
  }
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

class Reader {
 public:
  explicit Reader(const tinygltf::Model& model) : model_(model) {}

  Scene read() {
    if (model_.scenes.empty())
      throw InputError("holds no scene");
    const std::size_t chosen = model_.defaultScene < 0 ? 0 : static_cast<std::size_t>(model_.defaultScene);
    if (chosen >= model_.scenes.size())
      throw InputError(fmt::format("scene {}: does not exist", chosen));
    for (const int node : model_.scenes[chosen].nodes)
      add_node(node, std::nullopt, Eigen::Matrix3d::Identity(), 0);
    if (scene_.objects.empty())
      throw InputError("holds no triangles");
    return std::move(scene_);
  }

 private:
  /// Adds a node and its children. `rest` is the scaling and shear of the nodes above, which their links do
  /// not have.
  void add_node(int number, std::optional<std::size_t> parent, const Eigen::Matrix3d& rest,
                std::size_t depth) {
    const std::string what = fmt::format("node {}", number);
    if (number < 0 || static_cast<std::size_t>(number) >= model_.nodes.size())
      throw InputError(what + ": does not exist");
    if (!reached_.insert(number).second)
      throw InputError(what + ": is below two nodes, or below itself");
    if (depth > deepest)
      throw InputError(fmt::format("{}: is below more than {} others", what, deepest));
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(number)];
    try {
      if (node.skin != -1)
        throw InputError("has a skin, which is not read");
      add_link(node, number, parent, rest);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", what, error.what()));
    }
    const std::size_t index = scene_.links.size() - 1;
    const Eigen::Matrix3d below = rests_.back();
    for (const int child : node.children)
      add_node(child, index, below, depth + 1);
  }

  /// Adds the link of a node, and its mesh.
  void add_link(const tinygltf::Node& node, int number, std::optional<std::size_t> parent,
                const Eigen::Matrix3d& rest) {
    const NodePose pose = pose_of(node);
    Eigen::Isometry3d placed = Eigen::Isometry3d::Identity();
    placed.linear() = pose.rotation;
    placed.translation() = rest * pose.translation;
    // rest·rotation·(rest of this node) = rotation·below, so the rest of the nodes above moves below the
    // rotation.
    const Eigen::Matrix3d below = pose.rotation.transpose() * rest * pose.rotation * pose.rest;
    const std::string name = names_.take(node.name.empty() ? fmt::format("node {}", number) : node.name);
    scene_.links.push_back({name, parent, placed});
    rests_.push_back(rest.isIdentity(0) ? pose.rest : below);
    if (node.mesh != -1)
      add_object(name, node.mesh, rests_.back());
  }

  void add_object(const std::string& name, int number, const Eigen::Matrix3d& rest) {
    Mesh mesh{{}, 1, gltf_triangles(model_, number)};
    if (mesh.triangles.empty())
      return;
    if (!rest.isIdentity(0)) {
      const bool reflected = rest.determinant() < 0;
      for (Triangle& triangle : mesh.triangles) {
        for (Eigen::Vector3d& vertex : triangle)
          vertex = rest * vertex;
        // A reflection reverses the orientation of the triangles.
        if (reflected)
          std::swap(triangle[1], triangle[2]);
      }
    }
    scene_.objects.push_back({name, scene_.links.size() - 1, std::move(mesh)});
  }

  /// Limit of nesting, far above that of any model; nodes are read recursively, which takes space on the
  /// stack.
  static constexpr std::size_t deepest = 1000;

  const tinygltf::Model& model_;
  Scene scene_;
  std::vector<Eigen::Matrix3d> rests_;
  std::set<int> reached_;
  UniqueNames names_;
};

}  // namespace

Scene read_gltf(const fs::path& path) {
  try {
    const tinygltf::Model model = parse(path);
    return Reader(model).read();
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace fringe::cli
