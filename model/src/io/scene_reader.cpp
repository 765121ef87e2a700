#include "fringe/scene_reader.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/error.hpp"
#include "geometry/person.hpp"
#include "geometry/polygon.hpp"
#include "io/conductor_checks.hpp"
#include "io/mesh_formats.hpp"
#include "io/table_reader.hpp"

namespace fringe {
namespace {

using detail::Names;
using detail::read_pose;
using detail::TableReader;
using Eigen::Vector3d;

using LinkIndices = std::map<std::string, std::size_t, std::less<>>;

constexpr double degrees_per_radian = 180 / std::numbers::pi;
constexpr int default_segments = 48;
constexpr int fewest_segments = 3;
/// Largest number of triangles of a shape: a mesh of as many takes half a gigabyte, and more would exhaust
/// the memory.
constexpr int most_triangles = 10'000'000;

/// Reads the name of a table, by which messages then refer to it.
std::string read_name(TableReader& table, std::string_view kind, Names& used_names) {
  std::string name = table.name("name");
  if (!used_names.insert(name).second)
    table.fail("name", fmt::format("\"{}\" is already used", name));
  table.rename(fmt::format("{} \"{}\": ", kind, name));
  return name;
}

/// Lists the names of the links for a message.
std::string listed(const LinkIndices& links) {
  if (links.empty())
    return "the scene has none";
  std::vector<std::string> names;
  for (const auto& [name, index] : links)
    names.push_back(name);
  return fmt::format("there are {}", fmt::join(names, ", "));
}

std::optional<std::size_t> read_link_reference(TableReader& table, std::string_view key,
                                               const LinkIndices& links) {
  if (!table.has(key))
    return std::nullopt;
  const std::string name = table.text(key);
  const auto link = links.find(name);
  if (link == links.end())
    table.fail(key, fmt::format("there is no link \"{}\"; {}", name, listed(links)));
  return link->second;
}

/// Rejects cycles of links: a link that is its own ancestor would have no world pose.
void require_tree(const std::vector<Link>& links, const std::vector<TableReader>& tables) {
  for (std::size_t i = 0; i < links.size(); ++i) {
    std::size_t steps = 0;
    for (std::optional<std::size_t> parent = links[i].parent; parent; parent = links[*parent].parent)
      if (++steps > links.size() || *parent == i)
        tables[i].fail("parent", "the links form a cycle");
  }
}

/// Reads the joint of a link, whose pose is that at position 0.
Joint read_joint(TableReader table, const Eigen::Isometry3d& rest, Names& taken) {
  Joint joint;
  joint.name = table.name("name");
  if (!taken.insert(joint.name).second)
    table.fail("name", fmt::format("\"{}\" is taken", joint.name));
  const std::string type = table.text("type");
  if (type != "revolute" && type != "prismatic")
    table.fail("type", R"(must be "revolute" or "prismatic")");
  joint.kind = type == "revolute" ? Joint::Kind::revolute : Joint::Kind::prismatic;
  joint.axis = table.nonzero_vector("axis");
  joint.rest = rest;
  const double units = joint.kind == Joint::Kind::prismatic ? table.units_per_metre() : 1;
  if (table.has("lower"))
    joint.lower = table.number("lower") / units;
  if (table.has("upper"))
    joint.upper = table.number("upper") / units;
  if (joint.lower && joint.upper && *joint.upper < *joint.lower)
    table.fail("upper", "must not be less than lower");
  if (table.has("mimic")) {
    if (table.has("position"))
      table.fail("position", "cannot stand beside mimic");
    TableReader mimic = table.table("mimic");
    joint.mimic = Joint::Mimic{mimic.name("joint")};
    if (mimic.has("multiplier"))
      joint.mimic->multiplier = mimic.number("multiplier");
    if (mimic.has("offset"))
      joint.mimic->offset = mimic.number("offset") / units;
    mimic.finish();
  } else if (table.has("position")) {
    joint.position = table.number("position") / units;
  }
  table.finish();
  return joint;
}

/// Converts the multipliers of joints that follow one of the other kind, which are in units of length per rad
/// or the inverse.
void convert_multipliers(std::vector<Link>& links, double units_per_metre) {
  std::map<std::string, Joint::Kind, std::less<>> kinds;
  for (const Link& link : links)
    if (link.joint)
      kinds[link.joint->name] = link.joint->kind;
  for (Link& link : links) {
    if (!link.joint || !link.joint->mimic)
      continue;
    const auto leader = kinds.find(link.joint->mimic->joint);
    if (leader == kinds.end() || leader->second == link.joint->kind)
      continue;
    if (link.joint->kind == Joint::Kind::prismatic)
      link.joint->mimic->multiplier /= units_per_metre;
    else
      link.joint->mimic->multiplier *= units_per_metre;
  }
}

std::vector<Link> read_links(TableReader& root, LinkIndices& indices) {
  std::vector<TableReader> tables = root.tables("link");
  std::vector<Link> links;
  Names used_names, joints;
  for (TableReader& table : tables) {
    Link link;
    link.name = read_name(table, "link", used_names);
    indices[link.name] = links.size();
    link.pose = read_pose(table);
    if (table.has("joint"))
      link.joint = read_joint(table.table("joint"), link.pose, joints);
    links.push_back(std::move(link));
  }
  convert_multipliers(links, root.units_per_metre());
  // Parents are resolved last, because a link may refer to a parent that is described later.
  for (std::size_t i = 0; i < links.size(); ++i) {
    links[i].parent = read_link_reference(tables[i], "parent", indices);
    tables[i].finish();
  }
  require_tree(links, tables);
  try {
    place_joints(links);
  } catch (const InputError& error) {
    root.fail("link", error.what());
  }
  return links;
}

Medium read_medium(TableReader& root) {
  Medium medium;
  if (root.has("medium")) {
    TableReader table = root.table("medium");
    medium.relative_permittivity =
        table.positive_number_or("relative_permittivity", medium.relative_permittivity);
    table.finish();
  }
  return medium;
}

/// Returns whether there is a room. Its dimensions are checked but not stored, because the model only
/// considers what stands between a surface and a plate.
bool read_room(TableReader& root) {
  if (!root.has("room"))
    return false;
  TableReader table = root.table("room");
  table.positive_lengths("size", 3);
  read_pose(table);
  table.finish();
  return true;
}

/// Reads a plate. One whose edges are nearly at right angles is squared, which a sentence in `changes` tells.
Rectangle read_rectangle(TableReader& table, const std::string& place, std::vector<std::string>& changes) {
  for (const char* key : {"corner", "edge_u", "edge_v"})
    if (!table.has(key))
      table.fail(key, "is missing: a plate is a rectangle with corner, edge_u and edge_v; an electrode of "
                      "another shape is an object with potential = \"electrode\"");
  Rectangle rectangle{table.position("corner"), table.edge("edge_u"), table.edge("edge_v")};
  table.finish();
  const double cosine = cosine_between_edges(rectangle), size = std::abs(cosine);
  if (size > largest_cosine_squared)
    table.fail(
        "edge_v",
        fmt::format("edge_u and edge_v are not at right angles: the angle between them is {:.6g} degrees, "
                    "its cosine {:.2g}, and at most {:g} is squared",
                    degrees_per_radian * std::acos(cosine), cosine, largest_cosine_squared));
  if (size > largest_cosine_of_rounding) {
    rectangle = squared(rectangle);
    changes.push_back(
        fmt::format("{}: edge_u and edge_v are {:.2g} degrees off the right angle and are squared", place,
                    degrees_per_radian * std::asin(size)));
  }
  try {
    validate(rectangle);
  } catch (const InputError& error) {
    table.fail("edge_v", error.what());
  }
  return rectangle;
}

/// Reads a sensor's key `cover` as dielectric bodies, one on the front of each plate: the side to which
/// edge_u × edge_v points. Adds them to `covers`.
void read_cover(TableReader& table, const Sensor& sensor, Names& used_names, std::vector<Object>& covers) {
  if (!table.has("cover"))
    return;
  TableReader cover = table.table("cover");
  const double thickness = cover.positive_length("thickness");
  const Dielectric dielectric{cover.positive_number("relative_permittivity")};
  if (dielectric.relative_permittivity < 1)
    cover.fail("relative_permittivity", "a cover's must be at least 1");
  cover.finish();
  for (std::size_t k = 0; k < sensor.plates.size(); ++k) {
    const Rectangle& plate = sensor.plates[k];
    const double length_u = plate.edge_u.norm(), length_v = plate.edge_v.norm();
    const Vector3d u = plate.edge_u / length_u, v = plate.edge_v / length_v, normal = u.cross(v);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() << u, v, normal;
    pose.translation() = plate.corner + (plate.edge_u + plate.edge_v) / 2 + thickness / 2 * normal;
    std::string name =
        k == 0 ? fmt::format("{} cover", sensor.name) : fmt::format("{} cover {}", sensor.name, k + 1);
    if (!used_names.insert(name).second)
      table.fail("cover", fmt::format("\"{}\" is already used", name));
    Object body{std::move(name), sensor.link, Cuboid{length_u, length_v, thickness}, pose, dielectric, false};
    body.conductor = sensor.name;
    covers.push_back(std::move(body));
  }
}

Sensor read_sensor(TableReader& table, const LinkIndices& links, Names& used_names,
                   std::vector<std::string>& changes, std::vector<Object>& covers) {
  Sensor sensor;
  sensor.name = read_name(table, "sensor", used_names);
  sensor.link = read_link_reference(table, "link", links);
  sensor.input_voltage = table.positive_number_or("input_voltage", sensor.input_voltage);
  sensor.coupling_capacitance = table.positive_number_or("coupling_capacitance", sensor.coupling_capacitance);
  for (TableReader& plate : table.tables("plates"))
    sensor.plates.push_back(read_rectangle(
        plate, fmt::format("sensor \"{}\": plates[{}]", sensor.name, sensor.plates.size()), changes));
  read_cover(table, sensor, used_names, covers);
  // First, because a plate may have been written with keys that belong into `plates`.
  table.finish();
  if (sensor.plates.empty())
    table.fail("plates", "a sensor needs at least one plate");
  return sensor;
}

DistanceSensor read_distance_sensor(TableReader& table, const LinkIndices& links, Names& used_names) {
  DistanceSensor sensor;
  sensor.name = read_name(table, "distance_sensor", used_names);
  sensor.link = read_link_reference(table, "link", links);
  sensor.apex = table.position("apex");
  sensor.direction = table.nonzero_vector("direction");
  sensor.full_angle_degrees = table.positive_number("full_angle_degrees");
  if (sensor.full_angle_degrees > 180)
    table.fail("full_angle_degrees", "must be at most 180");
  sensor.range = table.positive_length("range");
  table.finish();
  return sensor;
}

/// Reads the number of segments of a shape that has `each` triangles per segment.
int read_segments(TableReader& table, int each) {
  return table.whole_number_or("segments", fewest_segments, most_triangles / each, default_segments);
}

/// Reads the number of segments of a shape whose triangles form a grid, of about the square of that number.
int read_segments_of_grid(TableReader& table) {
  const auto most = static_cast<int>(std::sqrt(static_cast<double>(most_triangles)));
  return table.whole_number_or("segments", fewest_segments, most, default_segments);
}

Arc read_arc(TableReader& table) {
  const Arc arc{table.positive_length("inner_radius"), table.positive_length("outer_radius"),
                table.positive_length("height"), table.positive_number("degrees"), read_segments(table, 8)};
  if (arc.outer_radius <= arc.inner_radius)
    table.fail("outer_radius", "must be greater than inner_radius");
  if (arc.degrees > 360)
    table.fail("degrees", "must be at most 360");
  return arc;
}

/// Reads a cuboid, whose edges are round if there is a `rounding` above zero.
Shape read_cuboid(TableReader& table) {
  const std::vector<double> size = table.positive_lengths("size", 3);
  if (!table.has("rounding"))
    return Cuboid{size[0], size[1], size[2]};
  const double rounding = table.length("rounding"), most = *std::ranges::min_element(size) / 2;
  if (rounding < 0 || rounding > most)
    table.fail("rounding", fmt::format("must be from 0 to half the smallest size, {:g}", most));
  const int segments = read_segments_of_grid(table);
  if (rounding == 0)
    return Cuboid{size[0], size[1], size[2]};
  return RoundedCuboid{size[0], size[1], size[2], rounding, segments};
}

Polygon read_polygon(TableReader& table) {
  Polygon polygon{table.points("vertices")};
  if (const std::optional<std::string> defect = detail::defect_of_polygon(polygon.vertices))
    table.fail("vertices", *defect);
  return polygon;
}

/// Reads a mesh, and remarks on its faces.
Mesh read_mesh(TableReader& table, const std::filesystem::path& folder, std::vector<std::string>& remarks) {
  Mesh mesh{folder / table.name("file"), table.positive_number_or("scale", 1 / table.units_per_metre()), {}};
  try {
    detail::MeshContent content = detail::read_mesh_content(mesh.file);
    mesh.triangles = std::move(content.triangles);
    remarks = detail::remarks_on_faces(content.defects, mesh.scale);
  } catch (const InputError& error) {
    table.fail("file", error.what());
  }
  for (Triangle& triangle : mesh.triangles)
    for (Vector3d& vertex : triangle) {
      vertex *= mesh.scale;
      if (!(vertex.cwiseAbs().maxCoeff() <= detail::largest_number))
        table.fail("file", fmt::format("the mesh is larger than {:g}", detail::largest_number));
    }
  return mesh;
}

/// Reads a person, whose triangles are a mesh without a file.
Mesh read_person(TableReader& table) {
  const double height = table.positive_length("height");
  const std::string age = table.choice("age", {"adult", "child", "infant"});
  const std::string posture = table.choice("posture", {"standing", "lying", "arm_stretched"});
  return {{},
          1,
          detail::triangles_of_person(height,
                                      age == "adult"   ? detail::PersonAge::adult
                                      : age == "child" ? detail::PersonAge::child
                                                       : detail::PersonAge::infant,
                                      posture == "standing" ? detail::Posture::standing
                                      : posture == "lying"  ? detail::Posture::lying
                                                            : detail::Posture::arm_stretched)};
}

/// Reads a shape, and remarks on the faces of a mesh.
Shape read_shape(TableReader& table, const std::filesystem::path& folder, std::vector<std::string>& remarks) {
  const std::string type = table.text("type");
  if (type == "plate" || type == "plane") {
    const std::vector<double> size = table.positive_lengths("size", 2);
    return Plate{size[0], size[1]};
  }
  if (type == "cuboid" || type == "box")
    return read_cuboid(table);
  if (type == "cube") {
    const double size = table.positive_length("size");
    return Cuboid{size, size, size};
  }
  if (type == "cylinder")
    return Cylinder{table.positive_length("radius"), table.positive_length("height"),
                    read_segments(table, 4)};
  if (type == "cone")
    return Cone{table.positive_length("radius"), table.positive_length("height"), read_segments(table, 2)};
  if (type == "arc")
    return read_arc(table);
  if (type == "sphere")
    return Sphere{table.positive_length("radius"), read_segments_of_grid(table)};
  if (type == "ellipsoid") {
    const std::vector<double> axes = table.positive_lengths("semi_axes", 3);
    return Ellipsoid{axes[0], axes[1], axes[2], read_segments_of_grid(table)};
  }
  if (type == "capsule")
    return Capsule{table.positive_length("radius"), table.positive_length("length"),
                   read_segments_of_grid(table)};
  if (type == "disc")
    return Disc{table.positive_length("radius"), read_segments(table, 1)};
  if (type == "polygon")
    return read_polygon(table);
  if (type == "mesh")
    return read_mesh(table, folder, remarks);
  if (type == "person")
    return read_person(table);
  table.fail("type",
             fmt::format("\"{}\" is not a known shape; there are plate (or plane), cuboid (or box), cube, "
                         "cylinder, cone, arc, sphere, ellipsoid, capsule, disc, polygon, mesh and person",
                         type));
}

ElectricalRole read_role(TableReader& table) {
  if (table.has("material")) {
    for (const char* key : {"potential", "conductor", "to_ground"})
      if (table.has(key))
        table.fail("material", fmt::format("cannot be combined with {}", key));
    TableReader material = table.table("material");
    const Dielectric dielectric{material.positive_number("relative_permittivity")};
    material.finish();
    return dielectric;
  }
  const std::string potential = table.choice("potential", {"grounded", "floating", "electrode"});
  if (potential == "floating")
    return Floating{table.positive_number_or("to_ground", Floating{}.to_ground)};
  if (table.has("to_ground"))
    table.fail("to_ground", fmt::format("is a key of floating objects, and this one is {}", potential));
  if (potential == "electrode")
    return Electrode{};
  return Grounded{};
}

Object read_object(TableReader& table, const LinkIndices& links, Names& used_names,
                   const std::filesystem::path& folder, std::vector<std::string>& changes) {
  std::string name = read_name(table, "object", used_names);
  const std::optional<std::size_t> link = read_link_reference(table, "link", links);
  TableReader shape_table = table.table("shape");
  std::vector<std::string> remarks;
  Shape shape = read_shape(shape_table, folder, remarks);
  shape_table.finish();
  for (const std::string& remark : remarks)
    changes.push_back(fmt::format("object \"{}\": {}", name, remark));
  Object object{std::move(name),  link,
                std::move(shape), read_pose(table),
                read_role(table), table.boolean_or("collides", true)};
  if (table.has("conductor"))
    object.conductor = table.name("conductor");
  object.target = table.boolean_or("target", false);
  object.collides_with_parent = table.boolean_or("collides_with_parent", false);
  table.finish();
  return object;
}

Reading read_reading(TableReader& table, Names& used_names) {
  Reading reading;
  reading.name = read_name(table, "reading", used_names);
  reading.sense = table.name("sense");
  reading.drive = table.names("drive");
  if (table.has("noise"))
    reading.noise = table.positive_number("noise");
  if (table.has("threshold"))
    reading.threshold = table.positive_number("threshold");
  table.finish();
  return reading;
}

Scene read_scene(const toml::table& document, const std::string& source,
                 const std::filesystem::path& folder) {
  TableReader root(document, source, "");
  require_known_format(root);
  read_units(root);
  Scene scene;
  scene.medium = read_medium(root);
  scene.has_room = read_room(root);
  LinkIndices links;
  scene.links = read_links(root, links);
  Names used_names;
  std::vector<Object> covers;
  for (TableReader& table : root.tables("sensor"))
    scene.sensors.push_back(read_sensor(table, links, used_names, scene.changes, covers));
  for (TableReader& table : root.tables("distance_sensor"))
    scene.distance_sensors.push_back(read_distance_sensor(table, links, used_names));
  std::vector<TableReader> objects = root.tables("object");
  for (TableReader& table : objects)
    scene.objects.push_back(read_object(table, links, used_names, folder, scene.changes));
  std::vector<TableReader> readings = root.tables("reading");
  Names names_of_readings;
  for (TableReader& table : readings)
    scene.readings.push_back(read_reading(table, names_of_readings));
  root.finish();
  detail::require_conductors(scene, objects);
  detail::require_targets(scene, objects);
  detail::require_readings(scene, readings);
  if (scene.sensors.empty() && scene.objects.empty())
    root.fail("", "a scene needs at least one sensor or object");
  scene.objects.insert(scene.objects.begin(), covers.begin(), covers.end());
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path) {
  return read_scene(detail::parse_document(path), path.string(), path.parent_path());
}

Scene parse_scene(std::string_view text, const std::filesystem::path& folder) {
  const std::string source = "scene";
  return read_scene(detail::parse_text(text, source), source, folder);
}

}  // namespace fringe
