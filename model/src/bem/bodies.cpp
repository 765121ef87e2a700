#include "bem/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "bem/surface_contact.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry/winding_number.hpp"

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

void validate_sizes(const Object& object, std::initializer_list<double> sizes) {
  for (const double size : sizes)
    if (!std::isfinite(size) || size <= 0)
      throw InputError(fmt::format("object \"{}\": a size of {} is not positive", object.name, size));
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
      throw InputError(fmt::format("{}: triangle {} is too thin: less high than {} of its longest side", name,
                                   k, least_height));
    std::sort(corners.begin(), corners.end());
    const auto [other, is_new] = known.emplace(corners, k);
    if (!is_new)
      throw InputError(fmt::format("{}: the triangles {} and {} are the same", name, other->second, k));
  }
}

ChargedBody body_of(const Object& object, std::size_t conductor) {
  const Eigen::Isometry3d& pose = object.pose;
  ChargedBody body{conductor, {}, Vector3d::Zero(), fmt::format("object \"{}\"", object.name), object.link};
  if (const auto* plate = std::get_if<Plate>(&object.shape)) {
    validate_sizes(object, {plate->size_x, plate->size_y});
    body.faces.push_back(moved_face({Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY(),
                                     plate->size_x / 2, plate->size_y / 2, EdgeKind::thin},
                                    pose));
  } else if (const auto* cuboid = std::get_if<Cuboid>(&object.shape)) {
    validate_sizes(object, {cuboid->size_x, cuboid->size_y, cuboid->size_z});
    body.half_sides = Vector3d(cuboid->size_x, cuboid->size_y, cuboid->size_z) / 2;
    for (const ChargedFace& face : faces_of_box(body.half_sides))
      body.faces.push_back(moved_face(face, pose));
  } else {
    if (!pose.matrix().allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", body.name));
    body.triangles = triangulate(object.shape);
    validate_triangles(body.name, body.triangles);
    for (Triangle& triangle : body.triangles)
      triangle = transformed(triangle, pose);
  }
  return body;
}

/// Returns the vertices of all faces; the body is their convex hull.
std::vector<Vector3d> vertices(const ChargedBody& body) {
  std::vector<Vector3d> result;
  for (const ChargedFace& face : body.faces)
    for (const double u : {-face.half_u, face.half_u})
      for (const double v : {-face.half_v, face.half_v})
        result.emplace_back(face.centre + u * face.axis_u + v * face.axis_v);
  return result;
}

/// Returns the convex parts of a body: the hull of all faces, or the triangles.
std::vector<ConvexHull> hulls_of(const ChargedBody& body) {
  if (!body.faces.empty())
    return {vertices(body)};
  std::vector<ConvexHull> hulls;
  for (const Triangle& triangle : body.triangles)
    hulls.emplace_back(triangle.begin(), triangle.end());
  return hulls;
}

}  // namespace

bool sensors_have_panels(const ChargedBodies& bodies) {
  return std::any_of(bodies.bodies.begin(), bodies.bodies.end(), [&](const ChargedBody& body) {
    return body.conductor < bodies.sensors && body.faces.empty();
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
      result.bodies.push_back({result.names.size(), {face_of(plate)}, Vector3d::Zero(), name, sensor.link});
    }
    result.names.push_back(sensor.name);
  }
  result.sensors = result.names.size();
  for (const bool floating : {false, true})
    for (const Object& object : scene.objects) {
      if (std::holds_alternative<Dielectric>(object.role))
        throw InputError(
            fmt::format("object \"{}\" is dielectric: boundary elements know only conductors", object.name));
      if (std::holds_alternative<Floating>(object.role) != floating)
        continue;
      result.bodies.push_back(body_of(object, result.names.size()));
      result.names.push_back(object.name);
      result.floating += floating;
    }
  return result;
}

ChargedBody moved(const ChargedBody& body, const Eigen::Isometry3d& pose) {
  ChargedBody result = body;
  for (ChargedFace& face : result.faces) {
    face = moved_face(face, pose);
    if (!face.centre.allFinite() || !face.axis_u.allFinite() || !face.axis_v.allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", body.name));
  }
  for (Triangle& triangle : result.triangles) {
    triangle = transformed(triangle, pose);
    if (!triangle[0].allFinite())
      throw InputError(fmt::format("{}: its pose is not finite", body.name));
  }
  return result;
}

void refuse_contact(const ChargedBody& a, const ChargedBody& b) {
  const std::vector<ConvexHull> hulls_a = hulls_of(a), hulls_b = hulls_of(b);
  if (hulls_meet(hulls_a, hulls_b))
    throw InputError(
        fmt::format("{} and {} touch or cross: boundary elements need conductors apart", a.name, b.name));
  for (const auto& [outside, inside, points] : {std::tuple(&a, &b, &hulls_b), std::tuple(&b, &a, &hulls_a)})
    if (is_closed(outside->triangles) && is_in_polyhedron(outside->triangles, points->front().front()))
      throw InputError(fmt::format("{} is inside {}: boundary elements need conductors apart", inside->name,
                                   outside->name));
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
