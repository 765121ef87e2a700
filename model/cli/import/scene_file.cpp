#include "scene_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <deque>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/scene_reader.hpp"
#include "unique_names.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Files that are removed at the end unless they are kept.
class Unfinished {
 public:
  Unfinished() = default;
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
  ~Unfinished() {
    std::error_code ignored;
    for (const fs::path& path : paths_)
      fs::remove(path, ignored);
  }

  void add(const fs::path& path) { paths_.push_front(path); }
  void keep() { paths_.clear(); }

 private:
  std::deque<fs::path> paths_;  // the last first: a folder after what is in it
};

/// A basic string of TOML.
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
  // The sum turns -0.0 into 0.0.
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

std::string link_text(const Link& link, const Scene& scene) {
  std::string text = fmt::format("\n[[link]]\nname = {}\n", quoted(link.name));
  if (link.parent)
    text += fmt::format("parent = {}\n", quoted(scene.links[*link.parent].name));
  return text + pose_text(link.pose);
}

/// The shapes that robots are made of; plates, cones and arcs are not among them.
struct ShapeText {
  std::string mesh_file;

  std::string operator()(const Cuboid& cuboid) const {
    return fmt::format("type = \"cuboid\", size = [{}, {}, {}]", cuboid.size_x, cuboid.size_y, cuboid.size_z);
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
  return text + pose_text(object.pose);
}

/// A name that is one of a file everywhere.
std::string file_name(const std::string& name) {
  std::string result = name;
  std::replace_if(
      result.begin(), result.end(),
      [](unsigned char letter) { return std::isalnum(letter) == 0 && letter != '-'; }, '_');
  return result;
}

void append(std::string& bytes, std::uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>(number >> shift & 0xff);
}

/// A binary STL file: its coordinates have single precision, as those of all mesh files count.
std::string stl(const std::vector<Triangle>& triangles) {
  constexpr std::size_t header_size = 80;
  std::string bytes(header_size, ' ');
  append(bytes, static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& triangle : triangles) {
    // Readers find the normal by the order of the vertices.
    const std::array<Eigen::Vector3d, 4> rows{Eigen::Vector3d::Zero(), triangle[0], triangle[1], triangle[2]};
    for (const Eigen::Vector3d& row : rows)
      for (const double coordinate : row)
        append(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(coordinate)));
    bytes.append(2, '\0');
  }
  return bytes;
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.close();
  if (!file)
    throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

std::string heading(const Scene& scene, const std::string& source) {
  const std::string link =
      scene.links.empty() ? "" : fmt::format("link = {}, ", quoted(scene.links.back().name));
  return fmt::format("# From {}, by fringe import. What is missing are the sensors, for instance:\n"
                     "# sensor = [ {{ name = \"front\", {}plates = [ {{ corner = [0, 0, 0], edge_u = [0.1, "
                     "0, 0], edge_v = [0, "
                     "0.1, 0] }} ] }} ]\n"
                     "format = 1\n",
                     quoted(source), link);
}

}  // namespace

void write_scene_file(const Scene& scene, const fs::path& target, const std::string& source) {
  Unfinished unfinished;
  const fs::path folder = target.stem().string() + "_meshes";
  const fs::path place = target.parent_path() / folder;
  std::string text = heading(scene, source);
  for (const Link& link : scene.links)
    text += link_text(link, scene);
  UniqueNames names;
  for (const Object& object : scene.objects) {
    std::string mesh_file;
    if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
      if (fs::create_directories(place))
        unfinished.add(place);
      const std::string name = names.take(file_name(object.name)) + ".stl";
      mesh_file = (folder / name).string();
      unfinished.add(place / name);
      write_bytes(place / name, stl(mesh->triangles));
    }
    text += object_text(object, scene, mesh_file);
  }
  const fs::path temporary = target.parent_path() / fmt::format(".{}.unfinished", target.filename().string());
  Unfinished scene_file;
  scene_file.add(temporary);
  write_bytes(temporary, text);
  try {
    load_scene(temporary);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{} makes no scene: {}", source, error.what()));
  }
  fs::rename(temporary, target);
  scene_file.keep();
  unfinished.keep();
}

}  // namespace fringe::cli
