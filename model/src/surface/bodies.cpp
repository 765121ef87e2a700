#include "surface/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "fringe/triangulation.hpp"
#include "numeric/interruption.hpp"
#include "surface/charged_readings.hpp"
#include "surface/contact.hpp"
#include "surface/corner_weld.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Shortest length of a body, in metres: capacitances, forces and their squares stay far from the smallest
/// numbers.
constexpr double shortest_length = 1e-30;

void refuse_shorter(const std::string& name, double length) {
  if (length < shortest_length)
    throw InputError(
        fmt::format("{}: a length of {:g} m is shorter than {:g} m", name, length, shortest_length));
}

ChargedFace face_of(const Rectangle& rectangle) {
  const double length_u = rectangle.edge_u.norm(), length_v = rectangle.edge_v.norm();
  const Vector3d axis_u = rectangle.edge_u / length_u;
  // Makes the axes exactly orthogonal: a rectangle's angles are right only up to a tolerance.
  const Vector3d axis_v = (rectangle.edge_v - rectangle.edge_v.dot(axis_u) * axis_u).normalized();
  return {rectangle.corner + (rectangle.edge_u + rectangle.edge_v) / 2,
          axis_u,
          axis_v,
          length_u / 2,
          length_v / 2,
          EdgeKind::thin};
}

ChargedFace moved_face(const ChargedFace& face, const Eigen::Isometry3d& pose) {
  return {
      pose * face.centre, pose.linear() * face.axis_u, pose.linear() * face.axis_v, face.half_u, face.half_v,
      face.edge};
}

/// Moves surfaces of every kind.
struct Motion {
  const Eigen::Isometry3d& pose;

  BodySurface operator()(const FlatPlate& plate) const { return FlatPlate{moved_face(plate.face, pose)}; }
  BodySurface operator()(const BoxSurface& box) const {
    BoxSurface result = box;
    for (ChargedFace& face : result.faces)
      face = moved_face(face, pose);
    return result;
  }
  BodySurface operator()(const TriangleSurface& surface) const {
    TriangleSurface result = surface;
    for (Triangle& triangle : result.triangles)
      triangle = transformed(triangle, pose);
    if (surface.round)
      result.round = surface.round->moved(pose);
    return result;
  }
};

/// Returns the surface of an object in its own frame.
struct SurfaceOfObject {
  const Object& object;
  const std::string& name;

  BodySurface operator()(const Plate& plate) const {
    validate_sizes({plate.size_x, plate.size_y});
    return plate_at_origin(plate.size_x / 2, plate.size_y / 2);
  }
  BodySurface operator()(const Cuboid& cuboid) const {
    validate_sizes({cuboid.size_x, cuboid.size_y, cuboid.size_z});
    return box_at_origin(Vector3d(cuboid.size_x, cuboid.size_y, cuboid.size_z) / 2);
  }
  template <typename Other>
  BodySurface operator()(const Other&) const {
    if (!object.pose.matrix().allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", name));
    const Vector3d sides = axis_aligned_box(triangulate(object.shape)).sizes();
    // Rounding may leave a thickness in a flat mesh.
    for (const double side : sides)
      if (!std::is_same_v<Other, Mesh> && side > 0)
        refuse_shorter(name, side);
    refuse_shorter(name, sides.maxCoeff());
    return surface_of(object);
  }

 private:
  void validate_sizes(std::initializer_list<double> sizes) const {
    for (const double size : sizes) {
      if (!std::isfinite(size) || size <= 0)
        throw InputError(fmt::format("{}: a size of {} is not positive", name, size));
      refuse_shorter(name, size);
    }
  }
};

ChargedBody body_of(const Object& object, std::size_t conductor) {
  const std::string name = fmt::format("object \"{}\"", object.name);
  const BodySurface surface = std::visit(SurfaceOfObject{object, name}, object.shape);
  return {conductor, 0, std::visit(Motion{object.pose}, surface), name, object.link};
}

Role role_of(const Object& object) {
  if (std::holds_alternative<Dielectric>(object.role))
    throw InputError(fmt::format(
        "object \"{}\" is dielectric: charges on triangles are known of conductors only; boundary-elements, "
        "the reduced method and the field solver take it",
        object.name));
  if (std::holds_alternative<Electrode>(object.role))
    return Role::electrode;
  return std::holds_alternative<Floating>(object.role) ? Role::floating : Role::grounded;
}

/// Returns the conductor that an object belongs to, which is added if no object before has named it. Throws
/// InputError if the conductor has another potential than the object.
std::size_t conductor_of(const Object& object, Role role, std::vector<ChargedConductor>& conductors) {
  const auto is_same = [&](const ChargedConductor& other) {
    return other.is_named && other.name == object.conductor;
  };
  const auto known = std::find_if(conductors.begin(), conductors.end(), is_same);
  if (known == conductors.end()) {
    conductors.push_back({object.conductor.value_or(object.name), role, {}, object.conductor.has_value()});
    return conductors.size() - 1;
  }
  if (known->role != role)
    throw InputError(fmt::format(R"(object "{}": conductor "{}" has one potential, but its objects differ)",
                                 object.name, known->name));
  return static_cast<std::size_t>(known - conductors.begin());
}

}  // namespace

FlatPlate plate_at_origin(double half_u, double half_v) {
  return {{Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY(), half_u, half_v, EdgeKind::thin}};
}

BoxSurface box_at_origin(const Vector3d& half_sides) {
  return {faces_of_box(half_sides), half_sides};
}

std::span<const ChargedFace> faces_of(const BodySurface& surface) {
  if (const auto* plate = std::get_if<FlatPlate>(&surface))
    return {&plate->face, 1};
  if (const auto* box = std::get_if<BoxSurface>(&surface))
    return box->faces;
  return {};
}

std::span<const Triangle> triangles_of(const BodySurface& surface) {
  const auto* triangles = std::get_if<TriangleSurface>(&surface);
  return triangles == nullptr ? std::span<const Triangle>() : triangles->triangles;
}

std::vector<Triangle> cleaned(const std::string& name, std::span<const Triangle> triangles) {
  /// Distance of corners that become one, relative to the size of the mesh: rounding of a file's numbers.
  constexpr double same_corner = 1e-10;
  /// Least height of a triangle, relative to its longest side. Below it, rounding in the integrals makes the
  /// matrix lose positive definiteness.
  constexpr double least_height = 1e-8;
  for (std::size_t k = 0; k < triangles.size(); ++k)
    for (const Vector3d& corner : triangles[k])
      if (!corner.allFinite())
        throw InputError(fmt::format("{}: triangle {} is not finite", name, k));
  CornerWeld corners(std::max(same_corner * axis_aligned_box(triangles).diagonal().norm(),
                              std::numeric_limits<double>::min()));
  const auto weld = [&](const Vector3d& corner) { return corners.corners()[corners.add(corner)]; };
  std::vector<Triangle> result;
  for (const Triangle& triangle : triangles) {
    check_interruption();
    const Triangle welded{weld(triangle[0]), weld(triangle[1]), weld(triangle[2])};
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i)
      longest = std::max(longest, (welded[(i + 1) % 3] - welded[i]).squaredNorm());
    const double doubled = twice_area(welded);
    if (doubled > 0 && doubled >= least_height * longest)
      result.push_back(welded);
  }
  if (result.empty())
    throw InputError(fmt::format("{}: no triangle has an area", name));
  return without_duplicates(std::move(result));
}

std::vector<Triangle> surface_triangles(const Object& object) {
  if (const auto round = RoundShape::of(object.shape, Eigen::Isometry3d::Identity()))
    return round->triangles();
  const std::vector<Triangle> triangles = triangulate(object.shape);
  return std::holds_alternative<Mesh>(object.shape)
             ? cleaned(fmt::format("object \"{}\"", object.name), triangles)
             : triangles;
}

TriangleSurface surface_of(const Object& object) {
  return {surface_triangles(object), RoundShape::of(object.shape, Eigen::Isometry3d::Identity())};
}

const RoundShape* round_shape_of(const BodySurface& surface) {
  const auto* triangles = std::get_if<TriangleSurface>(&surface);
  return triangles != nullptr && triangles->round ? &*triangles->round : nullptr;
}

TriangleSurface triangulated(const BodySurface& surface) {
  if (const auto* triangles = std::get_if<TriangleSurface>(&surface))
    return *triangles;
  TriangleSurface result;
  std::vector<Vector3d> corners;
  for (const ChargedFace& face : faces_of(surface)) {
    /// Distance below which two corners are the same: far above rounding, far below the length of an edge.
    const double same = 1e-9 * std::min(face.half_u, face.half_v);
    std::array<Vector3d, 4> own = corners_of(face);
    for (Vector3d& corner : own) {
      const auto known = std::find_if(corners.begin(), corners.end(),
                                      [&](const Vector3d& other) { return (other - corner).norm() < same; });
      corner = known == corners.end() ? corners.emplace_back(corner) : *known;
    }
    result.triangles.push_back({own[0], own[1], own[2]});
    result.triangles.push_back({own[0], own[2], own[3]});
  }
  return result;
}

AlignedBox3d bounds_of(const ChargedBody& body) {
  AlignedBox3d box = axis_aligned_box(triangles_of(body.surface));
  for (const ChargedFace& face : faces_of(body.surface))
    for (const Vector3d& corner : corners_of(face))
      box.extend(corner);
  return box;
}

void refuse_rounding(const std::string& name, const AlignedBox3d& box) {
  const double size = box.diagonal().norm(),
               farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  if (farthest * std::numeric_limits<double>::epsilon() > touching_surfaces * size)
    throw InputError(fmt::format("{}: it is {:.3g} m long and {:.3g} m away from the origin, where rounding "
                                 "changes its shape: move all to the origin, or leave out what is far away",
                                 name, size, farthest));
}

std::size_t count_of(const ChargedBodies& bodies, Role role) {
  const auto has_role = [&](const ChargedConductor& conductor) { return conductor.role == role; };
  return static_cast<std::size_t>(
      std::count_if(bodies.conductors.begin(), bodies.conductors.end(), has_role));
}

bool sensors_have_panels(const ChargedBodies& bodies) {
  return std::any_of(bodies.bodies.begin(), bodies.bodies.end(), [&](const ChargedBody& body) {
    return bodies.role(body) == Role::sensor && std::holds_alternative<TriangleSurface>(body.surface);
  });
}

ChargedBodies bodies_on_links(const Scene& scene) {
  ChargedBodies result;
  for (const Sensor& sensor : scene.sensors) {
    for (std::size_t k = 0; k < sensor.plates.size(); ++k) {
      const std::string name = fmt::format("sensor \"{}\" plates[{}]", sensor.name, k);
      const Rectangle& plate = sensor.plates[k];
      try {
        validate(plate);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", name, error.what()));
      }
      for (const Vector3d& edge : {plate.edge_u, plate.edge_v})
        refuse_shorter(name, edge.stableNorm());
      result.bodies.push_back({result.conductors.size(), 0, FlatPlate{face_of(plate)}, name, sensor.link});
    }
    result.conductors.push_back({sensor.name, Role::sensor, {sensor.name}});
  }
  const double unit = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
  const std::vector<bool> are_targets = targets(scene);
  for (const bool are_floating : {false, true})
    for (std::size_t k = 0; k < scene.objects.size(); ++k) {
      const Object& object = scene.objects[k];
      const Role role = role_of(object);
      if ((role == Role::floating) != are_floating)
        continue;
      const std::size_t at = conductor_of(object, role, result.conductors);
      ChargedConductor& conductor = result.conductors[at];
      if (const auto* floating = std::get_if<Floating>(&object.role))
        conductor.to_ground = floating->to_ground / unit;
      result.bodies.push_back(body_of(object, at));
      result.bodies.back().member = conductor.members.size();
      result.bodies.back().is_target = are_targets[k];
      conductor.members.push_back(object.name);
    }
  if (count_of(result, Role::floating) == result.conductors.size())
    throw InputError("the scene has neither a sensor nor a grounded object");
  return result;
}

ChargedBody moved(const ChargedBody& body, const Eigen::Isometry3d& pose) {
  ChargedBody result{body.conductor, body.member, std::visit(Motion{pose}, body.surface),
                     body.name,      body.link,   body.is_target};
  for (const ChargedFace& face : faces_of(result.surface))
    if (!face.centre.allFinite() || !face.axis_u.allFinite() || !face.axis_v.allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", body.name));
  for (const Triangle& triangle : triangles_of(result.surface))
    if (!triangle[0].allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", body.name));
  refuse_rounding(result.name, bounds_of(result));
  return result;
}

ChargedBodies charged_bodies(const Scene& scene, bool with_readings) {
  const std::vector<Eigen::Isometry3d> link_poses = world_poses(scene.links);
  ChargedBodies result = bodies_on_links(scene);
  for (ChargedBody& body : result.bodies)
    body = moved(body, attachment_pose(link_poses, body.link));
  result = joined(std::move(result));
  if (with_readings || asks_for_changes(scene))
    result.readings = charged_readings(readings(scene), drivable_conductors(result));
  return result;
}

}  // namespace fringe::detail
