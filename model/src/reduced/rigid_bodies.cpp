#include "reduced/rigid_bodies.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "bem/box_self_interaction.hpp"
#include "bem/panel_mesh.hpp"
#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "reduced/prepared_mesh.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

Eigen::Isometry3d frame_of(const FlatPlate& plate) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  const ChargedFace& face = plate.face;
  frame.linear() << face.axis_u, face.axis_v, face.axis_u.cross(face.axis_v);
  frame.translation() = face.centre;
  return frame;
}

Eigen::Isometry3d frame_of(const BoxSurface& box) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  // Faces 0 and 4 are −x and −z, in the order of faces_of_box.
  frame.linear() << box.faces[4].axis_u, box.faces[0].axis_u, box.faces[0].axis_v;
  frame.translation() = (box.faces[0].centre + box.faces[1].centre) / 2;
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
  const std::size_t triangles = triangles_of(body.surface).size();
  PanelMesh mesh;
  if (triangles <= most_mesh_panels)
    mesh.add(0, triangles_of(body.surface));
  const std::size_t panels = std::max(triangles, mesh.panels().size());
  if (panels > most_mesh_panels)
    throw InputError(
        fmt::format("{} has {} triangles, which become {} panels: the reduced method takes at most {}",
                    body.name, triangles, panels, most_mesh_panels));
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

/// Finds the shape of a body of every kind.
struct ShapeFinder {
  const Object* object;  ///< nullptr for the plate of a sensor
  double accuracy;
  SharedShapes& shapes;

  RigidBody operator()(const FlatPlate& plate) const {
    const double scale = std::max(plate.face.half_u, plate.face.half_v);
    return {shapes.find(plate_at_origin(plate.face.half_u / scale, plate.face.half_v / scale)), scale,
            frame_of(plate)};
  }
  RigidBody operator()(const BoxSurface& box) const {
    const double scale = box.half_sides.maxCoeff();
    return {shapes.find(box_at_origin(box.half_sides / scale)), scale, frame_of(box)};
  }
  RigidBody operator()(const TriangleSurface&) const {
    const UnitTriangles unit = in_unit(surface_triangles(*object));
    try {
      return {shapes.find(unit.triangles, accuracy), unit.scale,
              object->pose * Eigen::Translation3d(unit.centre)};
    } catch (const InputError& error) {
      throw InputError(fmt::format("object \"{}\": {}", object->name, error.what()));
    }
  }
};

}  // namespace

PreparedShape* SharedShapes::find(const FacedSurface& surface) {
  for (const auto& shape : shapes_)
    if (shape->has_faces_of(surface))
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(surface));
  return shapes_.back().get();
}

PreparedShape* SharedShapes::find(const std::vector<Triangle>& triangles, double accuracy) {
  for (const auto& shape : shapes_)
    if (shape->mesh() != nullptr && shape->mesh()->triangles() == triangles)
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(triangles, accuracy));
  return shapes_.back().get();
}

std::vector<RigidBody> rigid_bodies(const Scene& scene, const ChargedBodies& bodies, double accuracy,
                                    SharedShapes& shapes) {
  for (const ChargedBody& body : bodies.bodies)
    refuse_large(body);
  const std::vector<const Object*> objects = ordered_objects(scene);
  // The plates of sensors come before the objects.
  const std::size_t plates = bodies.bodies.size() - objects.size();
  std::vector<RigidBody> rigid;
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k) {
    const Object* const object = k < plates ? nullptr : objects[k - plates];
    rigid.push_back(std::visit(ShapeFinder{object, accuracy, shapes}, bodies.bodies[k].surface));
  }
  return rigid;
}

}  // namespace fringe::detail
