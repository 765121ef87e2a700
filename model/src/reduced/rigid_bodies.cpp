#include "reduced/rigid_bodies.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "bem/panel_mesh.hpp"
#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "reduced/prepared_mesh.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

Vector3d half_sides_of(const ChargedBody& body) {
  return body.faces.size() == 1 ? Vector3d(body.faces[0].half_u, body.faces[0].half_v, 0) : body.half_sides;
}

Eigen::Isometry3d frame_of(const ChargedBody& body) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  if (body.faces.size() == 1) {
    const ChargedFace& face = body.faces[0];
    frame.linear() << face.axis_u, face.axis_v, face.axis_u.cross(face.axis_v);
    frame.translation() = face.centre;
    return frame;
  }
  // Faces 0 and 4 are −x and −z, in the order of faces_of_box.
  frame.linear() << body.faces[4].axis_u, body.faces[0].axis_u, body.faces[0].axis_v;
  frame.translation() = (body.faces[0].centre + body.faces[1].centre) / 2;
  return frame;
}

/// A body's triangles about the origin, in units of half their extent.
struct UnitTriangles {
  std::vector<Triangle> triangles;
  Vector3d centre;
  double scale;
};

UnitTriangles in_unit(std::vector<Triangle> triangles) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : triangles)
    for (const Vector3d& corner : triangle)
      box.extend(corner);
  const UnitTriangles unit{{}, box.center(), box.sizes().maxCoeff() / 2};
  for (Triangle& triangle : triangles)
    for (Vector3d& corner : triangle)
      corner = (corner - unit.centre) / unit.scale;
  return {std::move(triangles), unit.centre, unit.scale};
}

/// Throws InputError for a body of more triangles than can be prepared.
void refuse_large(const ChargedBody& body) {
  PanelMesh mesh;
  if (body.triangles.size() <= most_mesh_panels)
    mesh.add(0, body.triangles);
  if (std::max(body.triangles.size(), mesh.panels().size()) > most_mesh_panels)
    throw InputError(fmt::format("{} has {} triangles, hence {} panels: the reduced method ends at {}",
                                 body.name, body.triangles.size(),
                                 std::max(body.triangles.size(), mesh.panels().size()), most_mesh_panels));
}

/// Returns the objects in the order of bodies_on_links.
std::vector<const Object*> ordered_objects(const Scene& scene) {
  std::vector<const Object*> objects;
  for (const bool floating : {false, true})
    for (const Object& object : scene.objects)
      if (std::holds_alternative<Floating>(object.role) == floating)
        objects.push_back(&object);
  return objects;
}

RigidBody rigid_faces(const ChargedBody& body, SharedShapes& shapes) {
  const Vector3d half_sides = half_sides_of(body);
  const double scale = half_sides.maxCoeff();
  return {shapes.find(body.faces.size(), half_sides / scale), scale, frame_of(body)};
}

RigidBody rigid_mesh(const Object& object, double accuracy, SharedShapes& shapes) {
  const UnitTriangles unit = in_unit(triangulate(object.shape));
  try {
    return {shapes.find(unit.triangles, accuracy), unit.scale,
            object.pose * Eigen::Translation3d(unit.centre)};
  } catch (const InputError& error) {
    throw InputError(fmt::format("object \"{}\": {}", object.name, error.what()));
  }
}

}  // namespace

std::vector<RigidBody> rigid_bodies(const Scene& scene, const ChargedBodies& bodies, double accuracy,
                                    SharedShapes& shapes) {
  for (const ChargedBody& body : bodies.bodies)
    refuse_large(body);
  const std::vector<const Object*> objects = ordered_objects(scene);
  // The plates of sensors come before the objects.
  const std::size_t plates = bodies.bodies.size() - objects.size();
  std::vector<RigidBody> rigid;
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k)
    rigid.push_back(bodies.bodies[k].faces.empty() ? rigid_mesh(*objects[k - plates], accuracy, shapes)
                                                   : rigid_faces(bodies.bodies[k], shapes));
  return rigid;
}

}  // namespace fringe::detail
