#include "import/formats.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "import/link_tree.hpp"
#include "import/urdf_text.hpp"
#include "io/mesh_formats.hpp"
#include "unique_names.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* unknown_geometry = "unknown geometry type; there are box, cylinder, sphere and mesh";

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

urdf::ModelInterfaceSharedPtr parse(const fs::path& path, UrdfGeometry geometry,
                                    std::vector<std::string>& warnings) {
  const Told told;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(
        simplified_urdf(path, geometry == UrdfGeometry::collision ? "collision" : "visual", warnings));
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
class UrdfReader {
 public:
  UrdfReader(const fs::path& path, const UrdfRequest& request, std::vector<std::string>& warnings)
      : path_(path), request_(request), warnings_(warnings), model_(parse(path, request.geometry, warnings)) {
  }
  UrdfReader(const UrdfReader&) = delete;
  UrdfReader& operator=(const UrdfReader&) = delete;
  /// Breaks the parser's ownership of children by their parents: links in a circle would never be freed.
  ~UrdfReader() {
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
      fail("robot", request_.geometry == UrdfGeometry::collision
                        ? "no link has a collision geometry; --geometry visual takes what is to be seen"
                        : "no link has a visual geometry");
    set_joints();
    return std::move(scene_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& reason) const {
    throw InputError(fmt::format("{}: {}: {}", path_.string(), what, reason));
  }

  void add_link(const urdf::Link& link, std::optional<std::size_t> parent) {
    const std::size_t index = scene_.links.size();
    reached_[link.name] = index;
    scene_.links.push_back({link.name, parent});
    if (link.parent_joint) {
      scene_.links.back().pose = pose_of(link.parent_joint->parent_to_joint_origin_transform);
      scene_.links.back().joint = joint_of(*link.parent_joint, scene_.links.back().pose);
    }
    if (request_.geometry == UrdfGeometry::collision)
      for (const auto& body : link.collision_array)
        add_object(link.name, index, body->geometry, body->origin);
    else
      for (const auto& body : link.visual_array)
        add_object(link.name, index, body->geometry, body->origin);
    for (const auto& child : link.child_links)
      add_link(*child, index);
  }

  void warn(const std::string& what, const std::string& reason) const {
    warnings_.push_back(fmt::format("{}: {}: {}", path_.string(), what, reason));
  }

  static bool moves(const urdf::Joint& joint) {
    return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
           joint.type == urdf::Joint::PRISMATIC;
  }

  /// Returns the joint of a link whose pose is `rest` at position 0; none if it cannot move.
  std::optional<Joint> joint_of(const urdf::Joint& joint, const Eigen::Isometry3d& rest) const {
    const std::string what = fmt::format("joint \"{}\"", joint.name);
    if (!rest.matrix().allFinite())
      fail(what, "its place must be finite");
    if (!moves(joint)) {
      if (joint.type != urdf::Joint::FIXED)
        warn(what, "is floating or planar, and stays at its origin");
      return std::nullopt;
    }
    Joint result;
    result.name = joint.name;
    result.kind = joint.type == urdf::Joint::PRISMATIC ? Joint::Kind::prismatic : Joint::Kind::revolute;
    result.axis = {joint.axis.x, joint.axis.y, joint.axis.z};
    result.rest = rest;
    if (!result.axis.allFinite() || result.axis.isZero(0))
      fail(what, "its axis must not be zero");
    // The parser sets limits that are not given to zero.
    if (joint.limits && joint.type != urdf::Joint::CONTINUOUS && joint.limits->lower < joint.limits->upper) {
      result.lower = joint.limits->lower;
      result.upper = joint.limits->upper;
    }
    if (joint.mimic)
      follow(*joint.mimic, what, result);
    return result;
  }

  /// Lets a joint follow another one; one that cannot move leaves it at the offset.
  void follow(const urdf::JointMimic& mimic, const std::string& what, Joint& joint) const {
    const auto leader = model_->joints_.find(mimic.joint_name);
    if (leader != model_->joints_.end() && moves(*leader->second)) {
      joint.mimic = Joint::Mimic{mimic.joint_name, mimic.multiplier, mimic.offset};
      return;
    }
    if (leader == model_->joints_.end())
      warn(what,
           fmt::format("mimics \"{}\", which does not exist; it stays at its offset", mimic.joint_name));
    joint.position = mimic.offset;
  }

  /// Moves the joints to the positions that are asked for.
  void set_joints() {
    for (const auto& [name, position] : request_.joints)
      set_joint(name, position);
    try {
      place_joints(scene_.links);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", path_.string(), error.what()));
    }
    for (const Link& link : scene_.links)
      if (link.joint && (link.joint->position != 0 || request_.joints.contains(link.joint->name)))
        warn_beyond_limits(*link.joint);
  }

  void set_joint(const std::string& name, double position) {
    const std::string what = fmt::format("joint \"{}\"", name);
    std::vector<std::string> choices;
    for (Link& link : scene_.links) {
      if (!link.joint)
        continue;
      if (!link.joint->mimic)
        choices.push_back(link.joint->name);
      if (link.joint->name != name)
        continue;
      if (link.joint->mimic)
        fail(what, fmt::format("follows \"{}\" and cannot be set", link.joint->mimic->joint));
      link.joint->position = position;
      return;
    }
    fail(what, choices.empty()
                   ? "does not exist, nor does any other that moves"
                   : fmt::format("does not exist or does not move; there are: {}", fmt::join(choices, ", ")));
  }

  void warn_beyond_limits(const Joint& joint) const {
    if ((joint.lower && joint.position < *joint.lower) || (joint.upper && joint.position > *joint.upper))
      warn(fmt::format("joint \"{}\"", joint.name),
           fmt::format("the position {} is beyond its limits, {} to {}", joint.position, *joint.lower,
                       *joint.upper));
  }

  void add_object(const std::string& link, std::size_t index, const urdf::GeometrySharedPtr& geometry,
                  const urdf::Pose& origin) {
    const std::string what = fmt::format("link \"{}\"", link);
    if (!geometry)
      fail(what, unknown_geometry);
    if (std::optional<Placed> body = body_of(*geometry, what))
      scene_.objects.push_back(
          {names_.take(link), index, std::move(body->shape), pose_of(origin) * body->pose});
  }

  /// A shape and its pose in the frame of its geometry.
  struct Placed {
    Shape shape;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  };

  /// Returns the shape of a geometry; none, with a warning, if it is left out.
  std::optional<Placed> body_of(const urdf::Geometry& geometry, const std::string& what) const {
    switch (geometry.type) {
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
      return box_of({size.x, size.y, size.z}, what);
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      require_sizes({cylinder.radius, cylinder.length}, what, "cylinder");
      if (cylinder.radius == 0)
        return left_out(what, "cylinder");
      if (cylinder.length == 0)
        return Placed{Disc{cylinder.radius, default_segments}};
      return Placed{Cylinder{cylinder.radius, cylinder.length, default_segments}};
    }
    case urdf::Geometry::SPHERE: {
      const double radius = static_cast<const urdf::Sphere&>(geometry).radius;
      require_sizes({radius}, what, "sphere");
      return radius == 0 ? left_out(what, "sphere") : std::optional(Placed{Sphere{radius, default_segments}});
    }
    case urdf::Geometry::MESH:
      try {
        return Placed{mesh_of(static_cast<const urdf::Mesh&>(geometry), what)};
      } catch (const InputError& error) {
        if (request_.missing == MissingMesh::refuse)
          throw InputError(fmt::format("{}; --missing leave-out imports the robot without it", error.what()));
        warnings_.push_back(fmt::format("{}; it is left out", error.what()));
        return std::nullopt;
      }
    }
    fail(what, unknown_geometry);
  }

  /// Returns a box, or a plate in place of one without thickness.
  std::optional<Placed> box_of(const Eigen::Vector3d& size, const std::string& what) const {
    require_sizes({size.x(), size.y(), size.z()}, what, "box");
    const auto flat = (size.array() == 0).count();
    if (flat > 1)
      return left_out(what, "box");
    if (flat == 0)
      return Placed{Cuboid{size.x(), size.y(), size.z()}};
    // The normal of a plate is z.
    Eigen::Index normal = 0;
    size.minCoeff(&normal);
    const Eigen::Index u = (normal + 1) % 3, v = (normal + 2) % 3;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() << Eigen::Vector3d::Unit(u), Eigen::Vector3d::Unit(v), Eigen::Vector3d::Unit(normal);
    return Placed{Plate{size[u], size[v]}, pose};
  }

  /// Throws InputError unless all sizes are finite and none is negative.
  void require_sizes(const std::vector<double>& sizes, const std::string& what,
                     std::string_view shape) const {
    for (const double size : sizes)
      if (!(size >= 0) || !std::isfinite(size))
        fail(what, fmt::format("{}: a size must not be less than zero, but is {}", shape, size));
  }

  std::optional<Placed> left_out(const std::string& what, std::string_view shape) const {
    warn(what, fmt::format("{}: has no size, and is left out", shape));
    return std::nullopt;
  }

  /// Reads and scales a mesh file.
  Mesh mesh_of(const urdf::Mesh& mesh, const std::string& what) const {
    const Eigen::Vector3d scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
    if (!scale.allFinite() || scale.prod() == 0)
      fail(what, "mesh: the scale must not be zero");
    const fs::path file = find(mesh.filename, what);
    Mesh result{file, 1, {}};
    std::vector<std::string> remarks;
    try {
      result.triangles = triangles_of(file, remarks);
    } catch (const InputError& error) {
      fail(what, fmt::format("mesh: {}", error.what()));
    }
    for (const std::string& remark : remarks)
      warn(what, fmt::format("mesh: {}", remark));
    transform(result.triangles, scale.asDiagonal().toDenseMatrix());
    return result;
  }

  static std::vector<Triangle> triangles_of(const fs::path& file, std::vector<std::string>& remarks) {
    const std::string extension = extension_of(file);
    if (extension == ".gltf" || extension == ".glb")
      return triangles_in_world(read_gltf(file));
    if (extension == ".stl" || extension == ".obj" || extension == ".ply") {
      detail::MeshContent content = detail::read_mesh_content(file);
      remarks = detail::remarks_on_faces(content.defects, 1);
      return std::move(content.triangles);
    }
    if (!is_model_file(file))
      throw InputError(
          fmt::format("{}: must end in .stl, .obj, .ply, .dae, .3mf, .gltf or .glb", file.string()));
    return read_model_triangles(file, remarks);
  }

  /// Finds the mesh file that a URDF names.
  fs::path find(const std::string& name, const std::string& what) const {
    constexpr std::string_view package = "package://";
    constexpr std::string_view file = "file://";
    const fs::path folder = fs::absolute(path_).parent_path();
    if (!name.starts_with(package)) {
      if (name.starts_with("http://") || name.starts_with("https://"))
        fail(what, fmt::format("mesh: {} is on the web; only files of this computer are read", name));
      if (name.find("://") != std::string::npos && !name.starts_with(file))
        fail(what,
             fmt::format("mesh: {} is none of the addresses that are read: package://, file:// and paths",
                         name));
      fs::path found = folder / (name.starts_with(file) ? name.substr(file.size()) : name);
      if (!fs::is_regular_file(found))
        fail(what, fmt::format("mesh: there is no file {}", found.string()));
      return found;
    }
    const std::string rest = name.substr(package.size());
    // Some robots write three slashes.
    const fs::path within = rest.substr(std::min(rest.find_first_not_of('/'), rest.size()));
    for (const fs::path& place : request_.package_paths)
      if (fs::is_regular_file(place / within))
        return place / within;
    if (const std::optional<fs::path> found = above(within))
      return *found;
    if (rest.starts_with('/') && fs::is_regular_file(rest))
      return rest;
    // The folder of the package may have another name than the package.
    fs::path without_package;
    for (auto part = within.begin(); part != within.end(); ++part)
      if (part != within.begin())
        without_package /= *part;
    if (const std::optional<fs::path> found = above(without_package)) {
      warn(what, fmt::format("mesh: {} is taken from {}", name, found->string()));
      return *found;
    }
    fail(what,
         fmt::format("mesh: {} was not found; --package-path names the folder that holds the package", name));
  }

  /// Finds a file in the folders that contain the URDF file.
  std::optional<fs::path> above(const fs::path& within) const {
    for (fs::path place = fs::absolute(path_).parent_path();; place = place.parent_path()) {
      if (!within.empty() && fs::is_regular_file(place / within))
        return place / within;
      if (place == place.parent_path())
        return std::nullopt;
    }
  }

  static constexpr int default_segments = 48;
  /// Limit of links, far above that of any robot; links are read recursively, which takes space on the stack.
  static constexpr std::size_t most_links = 10000;

  const fs::path& path_;
  const UrdfRequest& request_;
  std::vector<std::string>& warnings_;
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

MissingMesh parse_missing_mesh(const std::string& name) {
  if (name == "refuse")
    return MissingMesh::refuse;
  if (name == "leave-out")
    return MissingMesh::leave_out;
  throw InputError(fmt::format("--missing: must be refuse or leave-out, not {}", name));
}

Scene read_urdf(const fs::path& path, const UrdfRequest& request, std::vector<std::string>& warnings) {
  return UrdfReader(path, request, warnings).read();
}

}  // namespace fringe::cli
