#include "bem/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

#include <fmt/format.h>

#include "bem/contact.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

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

void validate_triangles(const std::string& name, const std::vector<Triangle>& triangles) {
  /// Least height of a triangle, relative to its longest side. Below it, rounding in the integrals makes the
  /// matrix lose positive definiteness.
  constexpr double least_height = 1e-8;
  using Corner = std::array<double, 3>;
  std::map<std::array<Corner, 3>, std::size_t> known;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    double longest = 0;
    std::array<Corner, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d& corner = triangles[k][i];
      if (!corner.allFinite())
        throw InputError(fmt::format("{}: triangle {} is not finite", name, k));
      corners[i] = {corner.x(), corner.y(), corner.z()};
      longest = std::max(longest, (triangles[k][(i + 1) % 3] - corner).squaredNorm());
    }
    const double doubled = twice_area(triangles[k]);
    if (!(doubled > 0))
      throw InputError(fmt::format("{}: triangle {} has no area", name, k));
    if (doubled < least_height * longest)
      throw InputError(
          fmt::format("{}: triangle {} is too thin: its height is less than {} of its longest side", name, k,
                      least_height));
    std::sort(corners.begin(), corners.end());
    const auto [other, is_new] = known.emplace(corners, k);
    if (!is_new)
      throw InputError(fmt::format("{}: the triangles {} and {} are the same", name, other->second, k));
  }
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
    TriangleSurface surface{triangulate(object.shape)};
    validate_triangles(name, surface.triangles);
    return surface;
  }

 private:
  void validate_sizes(std::initializer_list<double> sizes) const {
    for (const double size : sizes)
      if (!std::isfinite(size) || size <= 0)
        throw InputError(fmt::format("{}: a size of {} is not positive", name, size));
  }
};

ChargedBody body_of(const Object& object, std::size_t conductor) {
  const std::string name = fmt::format("object \"{}\"", object.name);
  const BodySurface surface = std::visit(SurfaceOfObject{object, name}, object.shape);
  return {conductor, std::visit(Motion{object.pose}, surface), name, object.link};
}

Role role_of(const Object& object) {
  if (std::holds_alternative<Dielectric>(object.role))
    throw InputError(
        fmt::format("object \"{}\" is dielectric: boundary elements compute only conductors", object.name));
  if (std::holds_alternative<Electrode>(object.role))
    throw InputError(fmt::format(
        "object \"{}\" is an electrode: boundary elements know only grounded and floating objects",
        object.name));
  if (object.conductor)
    throw InputError(fmt::format("object \"{}\" belongs to conductor \"{}\": boundary elements know only "
                                 "conductors of one object each",
                                 object.name, *object.conductor));
  return std::holds_alternative<Floating>(object.role) ? Role::floating : Role::grounded;
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

std::vector<std::string> names_of(const ChargedBodies& bodies, Role role) {
  std::vector<std::string> names;
  for (const ChargedConductor& conductor : bodies.conductors)
    if (conductor.role == role)
      names.push_back(conductor.name);
  return names;
}

std::size_t count_of(const ChargedBodies& bodies, Role role) {
  return names_of(bodies, role).size();
}

bool electrodes_have_panels(const ChargedBodies& bodies) {
  return std::any_of(bodies.bodies.begin(), bodies.bodies.end(), [&](const ChargedBody& body) {
    return bodies.role(body) == Role::electrode && std::holds_alternative<TriangleSurface>(body.surface);
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
      result.bodies.push_back({result.conductors.size(), FlatPlate{face_of(plate)}, name, sensor.link});
    }
    result.conductors.push_back({sensor.name, Role::electrode});
  }
  for (const Role role : {Role::grounded, Role::floating})
    for (const Object& object : scene.objects) {
      if (role_of(object) != role)
        continue;
      result.bodies.push_back(body_of(object, result.conductors.size()));
      result.conductors.push_back({object.name, role});
    }
  if (count_of(result, Role::floating) == result.conductors.size())
    throw InputError("the scene has neither a sensor nor a grounded object");
  return result;
}

ChargedBody moved(const ChargedBody& body, const Eigen::Isometry3d& pose) {
  ChargedBody result{body.conductor, std::visit(Motion{pose}, body.surface), body.name, body.link};
  for (const ChargedFace& face : faces_of(result.surface))
    if (!face.centre.allFinite() || !face.axis_u.allFinite() || !face.axis_v.allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", body.name));
  for (const Triangle& triangle : triangles_of(result.surface))
    if (!triangle[0].allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", body.name));
  return result;
}

ChargedBodies charged_bodies(const Scene& scene) {
  const std::vector<Eigen::Isometry3d> link_poses = world_poses(scene.links);
  ChargedBodies result = bodies_on_links(scene);
  for (ChargedBody& body : result.bodies)
    body = moved(body, attachment_pose(link_poses, body.link));
  for (std::size_t a = 0; a < result.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < result.bodies.size(); ++b)
      refuse_contact(result.bodies[a], result.bodies[b]);
  return result;
}

}  // namespace fringe::detail
