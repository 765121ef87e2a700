#include "urdf.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "fringe/error.hpp"
#include "fringe/mesh_file.hpp"
#include "fringe/pose.hpp"
#include "unique_names.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Collects the parser's error messages about a file, which it writes to its console only.
class Told final : public console_bridge::OutputHandler {
 public:
  Told() { console_bridge::useOutputHandler(this); }
  Told(const Told&) = delete;
  Told& operator=(const Told&) = delete;
  ~Told() override { console_bridge::restorePreviousOutputHandler(); }

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR)
      text_ += (text_.empty() ? "" : "; ") + text;
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!fs::is_regular_file(path) || !file)
    throw InputError(fmt::format("{}: the file does not exist or cannot be read", path.string()));
  return {std::istreambuf_iterator<char>(file), {}};
}

urdf::ModelInterfaceSharedPtr parse(const fs::path& path) {
  const Told told;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text_of(path));
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
  // The parser reports a geometry that it cannot read, and skips it.
  if (!model || !told.text().empty())
    throw InputError(
        fmt::format("{}: {}", path.string(), told.text().empty() ? "is not a robot in URDF" : told.text()));
  return model;
}

Eigen::Isometry3d pose_of(const urdf::Pose& pose) {
  const urdf::Rotation& turn = pose.rotation;
  return pose_from_quaternion(Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z),
                              {pose.position.x, pose.position.y, pose.position.z});
}

/// Reads one robot. The parameter `what` is the element of the file that an error message names.
class Reader {
 public:
  Reader(const fs::path& path, UrdfGeometry geometry, const std::vector<fs::path>& package_paths)
      : path_(path), geometry_(geometry), package_paths_(package_paths), model_(parse(path)) {}
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  /// Breaks the parser's ownership of children by their parents: links in a circle would never be freed.
  ~Reader() {
    for (const auto& [name, link] : model_->links_)
      link->child_links.clear();
  }

  Scene read() {
    if (model_->links_.size() > most_links)
      fail("robot", fmt::format("has more than {} links", most_links));
    add_link(*model_->getRoot(), std::nullopt);
    if (scene_.links.size() != model_->links_.size())
      for (const auto& [name, link] : model_->links_)
        if (!reached_.contains(name))
          fail(fmt::format("link \"{}\"", name), "the root does not lead to it");
    if (scene_.objects.empty())
      fail("robot", geometry_ == UrdfGeometry::collision
                        ? "no link has a collision geometry; --geometry visual takes what is to be seen"
                        : "no link has a visual geometry");
    return std::move(scene_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& reason) const {
    throw InputError(fmt::format("{}: {}: {}", path_.string(), what, reason));
  }

  void add_link(const urdf::Link& link, std::optional<std::size_t> parent) {
    const std::size_t index = scene_.links.size();
    reached_[link.name] = index;
    scene_.links.push_back(
        {link.name, parent,
         link.parent_joint ? joint_pose(*link.parent_joint) : Eigen::Isometry3d::Identity()});
    if (geometry_ == UrdfGeometry::collision)
      for (const auto& body : link.collision_array)
        add_object(link.name, index, body->geometry, body->origin);
    else
      for (const auto& body : link.visual_array)
        add_object(link.name, index, body->geometry, body->origin);
    for (const auto& child : link.child_links)
      add_link(*child, index);
  }

  Eigen::Isometry3d joint_pose(const urdf::Joint& joint) const {
    const std::string what = fmt::format("joint \"{}\"", joint.name);
    Eigen::Isometry3d origin = pose_of(joint.parent_to_joint_origin_transform);
    const double position = joint_position(joint, 0);
    if (!origin.matrix().allFinite() || !std::isfinite(position))
      fail(what, "its place must be finite");
    if (position == 0)
      return origin;
    const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
    if (!axis.allFinite() || axis.isZero(0))
      fail(what, "its axis must not be zero");
    if (joint.type == urdf::Joint::PRISMATIC)
      return origin * Eigen::Translation3d(position * axis.stableNormalized());
    return origin * Eigen::AngleAxisd(position, axis.stableNormalized());
  }

  /// Returns the joint's position: 0, or the one that follows from the joint that it mimics.
  double joint_position(const urdf::Joint& joint, std::size_t depth) const {
    if (!joint.mimic)
      return 0;
    const auto mimicked = model_->joints_.find(joint.mimic->joint_name);
    if (mimicked == model_->joints_.end())
      fail(fmt::format("joint \"{}\"", joint.name),
           fmt::format("mimics \"{}\", which does not exist", joint.mimic->joint_name));
    if (depth > model_->joints_.size())
      fail(fmt::format("joint \"{}\"", joint.name), "mimics itself");
    return joint.mimic->offset + joint.mimic->multiplier * joint_position(*mimicked->second, depth + 1);
  }

  void add_object(const std::string& link, std::size_t index, const urdf::GeometrySharedPtr& geometry,
                  const urdf::Pose& origin) {
    const std::string what = fmt::format("link \"{}\"", link);
    if (!geometry)
      fail(what, "unknown geometry type");
    scene_.objects.push_back({names_.take(link), index, shape_of(*geometry, what), pose_of(origin)});
  }

  Shape shape_of(const urdf::Geometry& geometry, const std::string& what) const {
    switch (geometry.type) {
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
      return Cuboid{positive(size.x, what, "box"), positive(size.y, what, "box"),
                    positive(size.z, what, "box")};
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      return Cylinder{positive(cylinder.radius, what, "cylinder"),
                      positive(cylinder.length, what, "cylinder"), default_segments};
    }
    case urdf::Geometry::SPHERE:
      return Sphere{positive(static_cast<const urdf::Sphere&>(geometry).radius, what, "sphere"),
                    default_segments};
    case urdf::Geometry::MESH:
      return mesh_of(static_cast<const urdf::Mesh&>(geometry), what);
    }
    fail(what, "unknown geometry type");
  }

  /// Returns a size; throws InputError unless it is positive and finite.
  double positive(double size, const std::string& what, std::string_view shape) const {
    if (!(size > 0) || !std::isfinite(size))
      fail(what, fmt::format("{}: a size must be greater than zero, not {}", shape, size));
    return size;
  }

  /// Reads and scales a mesh file.
  Mesh mesh_of(const urdf::Mesh& mesh, const std::string& what) const {
    const Eigen::Vector3d scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
    if (!scale.allFinite() || scale.prod() == 0)
      fail(what, "mesh: the scale must not be zero");
    const fs::path file = find(mesh.filename, what);
    Mesh result{file, 1, {}};
    try {
      result.triangles = read_mesh_file(file);
    } catch (const InputError& error) {
      fail(what, fmt::format("mesh: {}", error.what()));
    }
    for (Triangle& triangle : result.triangles) {
      for (Eigen::Vector3d& vertex : triangle)
        vertex = vertex.cwiseProduct(scale);
      // A reflection reverses the orientation of the triangles.
      if (scale.prod() < 0)
        std::swap(triangle[1], triangle[2]);
    }
    return result;
  }

  /// Finds the mesh file that a URDF names.
  fs::path find(const std::string& name, const std::string& what) const {
    constexpr std::string_view package = "package://";
    constexpr std::string_view file = "file://";
    const fs::path folder = fs::absolute(path_).parent_path();
    if (!name.starts_with(package)) {
      fs::path found = folder / (name.starts_with(file) ? name.substr(file.size()) : name);
      if (!fs::is_regular_file(found))
        fail(what, fmt::format("mesh: there is no file {}", found.string()));
      return found;
    }
    const fs::path within = name.substr(package.size());
    for (const fs::path& place : package_paths_)
      if (fs::is_regular_file(place / within))
        return place / within;
    for (fs::path place = folder;; place = place.parent_path()) {
      if (fs::is_regular_file(place / within))
        return place / within;
      if (place == place.parent_path())
        break;
    }
    fail(what,
         fmt::format("mesh: {} was not found; --package-path names the folder that holds the package", name));
  }

  static constexpr int default_segments = 48;
  /// Limit of links, far above that of any robot; links are read recursively, which takes space on the stack.
  static constexpr std::size_t most_links = 10000;

  const fs::path& path_;
  UrdfGeometry geometry_;
  const std::vector<fs::path>& package_paths_;
  urdf::ModelInterfaceSharedPtr model_;
  Scene scene_;
  std::map<std::string, std::size_t> reached_;
  UniqueNames names_;
};

}  // namespace

UrdfGeometry parse_urdf_geometry(const std::string& name) {
  if (name == "collision")
    return UrdfGeometry::collision;
  if (name == "visual")
    return UrdfGeometry::visual;
  throw InputError(fmt::format("--geometry: must be collision or visual, not {}", name));
}

Scene read_urdf(const fs::path& path, UrdfGeometry geometry, const std::vector<fs::path>& package_paths) {
  return Reader(path, geometry, package_paths).read();
}

}  // namespace fringe::cli
