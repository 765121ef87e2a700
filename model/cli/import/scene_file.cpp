#include "import/scene_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/scene_reader.hpp"
#include "unique_names.hpp"
#include "whole_files.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Writes a text as a basic string of TOML.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\')
      result += fmt::format("\\{}", letter);
    else if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f)
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(letter));
    else
      result += letter;
  }
  return result + '"';
}

std::string listed(const Eigen::Vector3d& vector) {
  // Adding 0.0 turns -0.0 into 0.0.
  return fmt::format("[{}, {}, {}]", vector.x() + 0.0, vector.y() + 0.0, vector.z() + 0.0);
}

std::string pose_text(const Eigen::Isometry3d& pose) {
  std::string text;
  if (!pose.translation().isZero(0))
    text += fmt::format("translation = {}\n", listed(pose.translation()));
  if (!pose.linear().isIdentity(0)) {
    const Eigen::Quaterniond turn(pose.linear());
    text += fmt::format("quaternion = [{}, {}, {}, {}]\n", turn.w(), turn.x() + 0.0, turn.y() + 0.0,
                        turn.z() + 0.0);
  }
  return text;
}

std::string joint_text(const Joint& joint) {
  std::string text =
      fmt::format("joint = {{ name = {}, type = \"{}\", axis = {}", quoted(joint.name),
                  joint.kind == Joint::Kind::revolute ? "revolute" : "prismatic", listed(joint.axis));
  if (joint.lower)
    text += fmt::format(", lower = {}", *joint.lower);
  if (joint.upper)
    text += fmt::format(", upper = {}", *joint.upper);
  if (joint.mimic)
    text += fmt::format(", mimic = {{ joint = {}, multiplier = {}, offset = {} }}",
                        quoted(joint.mimic->joint), joint.mimic->multiplier, joint.mimic->offset);
  else
    text += fmt::format(", position = {}", joint.position);
  return text + " }\n";
}

std::string link_text(const Link& link, const Scene& scene) {
  std::string text = fmt::format("\n[[link]]\nname = {}\n", quoted(link.name));
  if (link.parent)
    text += fmt::format("parent = {}\n", quoted(scene.links[*link.parent].name));
  return text + (link.joint ? pose_text(link.joint->rest) + joint_text(*link.joint) : pose_text(link.pose));
}

/// Writes the shapes that imports produce; cones and arcs are not among them.
struct ShapeText {
  std::string mesh_file;

  std::string operator()(const Cuboid& cuboid) const {
    return fmt::format("type = \"cuboid\", size = [{}, {}, {}]", cuboid.size_x, cuboid.size_y, cuboid.size_z);
  }
  std::string operator()(const Plate& plate) const {
    return fmt::format("type = \"plate\", size = [{}, {}]", plate.size_x, plate.size_y);
  }
  std::string operator()(const Disc& disc) const {
    return fmt::format("type = \"disc\", radius = {}", disc.radius);
  }
  std::string operator()(const Cylinder& cylinder) const {
    return fmt::format("type = \"cylinder\", radius = {}, height = {}", cylinder.radius, cylinder.height);
  }
  std::string operator()(const Sphere& sphere) const {
    return fmt::format("type = \"sphere\", radius = {}", sphere.radius);
  }
  std::string operator()(const Mesh&) const {
    return fmt::format("type = \"mesh\", file = {}", quoted(mesh_file));
  }
  template <typename Other>
  std::string operator()(const Other&) const {
    throw std::logic_error("an imported shape that cannot be written");
  }
};

std::string object_text(const Object& object, const Scene& scene, const std::string& mesh_file) {
  std::string text = fmt::format("\n[[object]]\nname = {}\n", quoted(object.name));
  if (object.link)
    text += fmt::format("link = {}\n", quoted(scene.links[*object.link].name));
  text += fmt::format("shape = {{ {} }}\n", std::visit(ShapeText{mesh_file}, object.shape));
  if (std::holds_alternative<Electrode>(object.role))
    text += "potential = \"electrode\"\n";
  return text + pose_text(object.pose);
}

void append(std::string& bytes, std::uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>(number >> shift & 0xff);
}

/// Returns a binary STL file. Its coordinates have single precision, like those of all mesh files here.
std::string stl(const std::vector<Triangle>& triangles) {
  constexpr std::size_t header_size = 80;
  std::string bytes(header_size, ' ');
  append(bytes, static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& triangle : triangles) {
    // The normal is left zero; readers compute it from the order of the vertices.
    const std::array<Eigen::Vector3d, 4> rows{Eigen::Vector3d::Zero(), triangle[0], triangle[1], triangle[2]};
    for (const Eigen::Vector3d& row : rows)
      for (const double coordinate : row)
        append(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(coordinate)));
    bytes.append(2, '\0');
  }
  return bytes;
}

/// Returns the comment on sensors: an example, which counts when its marks # are taken away, or is copied,
/// unless there are electrodes.
std::string about_sensors(const Scene& scene) {
  const auto is_electrode = [](const Object& object) {
    return std::holds_alternative<Electrode>(object.role);
  };
  if (std::any_of(scene.objects.begin(), scene.objects.end(), is_electrode))
    return "# Its conductors are electrodes, which may be driven and sensed as sensors may.\n";
  const std::string link =
      scene.links.empty() ? "" : fmt::format("# link = {}\n", quoted(scene.links.back().name));
  return fmt::format("# What is missing are the sensors, for instance:\n"
                     "# [[sensor]]\n# name = \"front\"\n{}"
                     "# plates = [ {{ corner = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] }} ]\n",
                     link);
}

/// Returns the head of the scene file: where it is from, and the medium.
std::string heading(const Scene& scene, const std::string& source) {
  // The example stands below the format: it begins a table, in which the format would be another key.
  std::string text =
      fmt::format("# From {}, by fringe import.\nformat = 1\n\n{}", quoted(source), about_sensors(scene));
  if (scene.medium.relative_permittivity != 1)
    text += fmt::format("\n[medium]\nrelative_permittivity = {}\n", scene.medium.relative_permittivity);
  return text;
}

/// The names of the mesh files by the index of their object.
using MeshNames = std::map<std::size_t, std::string>;

/// Writes the meshes of a scene into a folder, which is created if there are any; errors name `target` in its
/// place.
MeshNames write_meshes(const Scene& scene, const fs::path& folder, const fs::path& target) {
  MeshNames written;
  UniqueNames names;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto* mesh = std::get_if<Mesh>(&scene.objects[i].shape);
    if (mesh == nullptr)
      continue;
    std::error_code failure;  // that of the file's says as much
    fs::create_directories(folder, failure);
    written[i] = names.take(plain_name(scene.objects[i].name, "-")) + ".stl";
    write_bytes(folder / written[i], stl(mesh->triangles), target / written[i]);
  }
  return written;
}

/// Returns the text of the scene file, with its meshes in `folder` beside it.
std::string scene_text(const Scene& scene, const std::string& source, const fs::path& folder,
                       const MeshNames& meshes) {
  std::string text = heading(scene, source);
  for (const Link& link : scene.links)
    text += link_text(link, scene);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto mesh = meshes.find(i);
    text +=
        object_text(scene.objects[i], scene, mesh == meshes.end() ? "" : (folder / mesh->second).string());
  }
  return text;
}

/// Removes the paths of temporary files, which no longer exist when the message is read.
std::string without_paths(std::string message, const fs::path& scene_file, const fs::path& mesh_folder) {
  if (message.starts_with(scene_file.string())) {
    const std::size_t place_ends = message.find(": ");
    message.erase(0, place_ends == std::string::npos ? 0 : place_ends + 2);
  }
  const std::string folder = (mesh_folder / "").string();
  if (const std::size_t at = message.find(folder); at != std::string::npos)
    message.erase(at, folder.size());
  return message;
}

}  // namespace

void write_scene_file(const Scene& scene, const fs::path& target, const std::string& source) {
  const fs::path beside = fs::absolute(target).parent_path();
  MissingFolders folders(beside);
  const std::string meshes = target.stem().string() + "_meshes";
  const Unfinished scene_file(unfinished_path(beside / target.filename()));
  const Unfinished mesh_folder(unfinished_path(beside / meshes));
  const MeshNames names = write_meshes(scene, mesh_folder.path(), beside / meshes);
  write_bytes(scene_file.path(), scene_text(scene, source, mesh_folder.path().filename(), names), target);
  try {
    load_scene(scene_file.path());
  } catch (const InputError& error) {
    throw InputError(fmt::format("{} makes no scene: {}", source,
                                 without_paths(error.what(), scene_file.path(), mesh_folder.path())));
  }
  // Existing files stay until the new scene is known to be valid.
  write_bytes(scene_file.path(), scene_text(scene, source, meshes, names), target);
  if (!names.empty())
    fs::create_directories(beside / meshes);
  for (const auto& [object, name] : names)
    rename_to(mesh_folder.path() / name, beside / meshes / name);
  rename_to(scene_file.path(), target);
  folders.keep();
}

}  // namespace fringe::cli
