#include "reduced/rigid_bodies.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "bem/box_self_interaction.hpp"
#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "reduced/prepared_mesh.hpp"
#include "reduced/single_body_system.hpp"

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

/// A body's surfaces about the origin, in units of half their extent.
struct UnitSurfaces {
  std::vector<TriangleSurface> surfaces;
  Vector3d centre;
  double scale;
};

UnitSurfaces in_unit(std::vector<TriangleSurface> surfaces) {
  Eigen::AlignedBox3d box;
  for (const auto& [triangles] : surfaces)
    for (const Triangle& triangle : triangles)
      for (const Vector3d& corner : triangle)
        box.extend(corner);
  const UnitSurfaces unit{{}, box.center(), box.sizes().maxCoeff() / 2};
  for (auto& [triangles] : surfaces)
    for (Triangle& triangle : triangles)
      for (Vector3d& corner : triangle)
        corner = (corner - unit.centre) / unit.scale;
  return {std::move(surfaces), unit.centre, unit.scale};
}

/// Throws InputError for a body of more triangles than can be prepared.
void refuse_large(const std::string& name, const std::vector<TriangleSurface>& surfaces) {
  std::size_t triangles = 0;
  for (const TriangleSurface& surface : surfaces)
    triangles += surface.triangles.size();
  const std::size_t panels =
      triangles > most_mesh_panels ? triangles : std::max(triangles, panels_of(surfaces).panels().size());
  if (panels > most_mesh_panels)
    throw InputError(
        fmt::format("{} has {} triangles, which become {} panels: the reduced method takes at most {}", name,
                    triangles, panels, most_mesh_panels));
}

/// Finds the shape of a body of surfaces of triangles, which are in the frame `on_link`.
RigidBody body_of_triangles(const std::string& name, std::vector<TriangleSurface> surfaces,
                            const Eigen::Isometry3d& on_link, double accuracy, SharedShapes& shapes) {
  const UnitSurfaces unit = in_unit(std::move(surfaces));
  try {
    return {
        shapes.find(unit.surfaces, accuracy), unit.scale, on_link * Eigen::Translation3d(unit.centre), {}};
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", name, error.what()));
  }
}

/// Finds the shape of a body of every kind.
struct ShapeFinder {
  const Object* object;  ///< nullptr for the plate of a sensor
  const std::string& name;
  double accuracy;
  SharedShapes& shapes;

  RigidBody operator()(const FlatPlate& plate) const {
    const double scale = std::max(plate.face.half_u, plate.face.half_v);
    return {shapes.find(plate_at_origin(plate.face.half_u / scale, plate.face.half_v / scale)),
            scale,
            frame_of(plate),
            {}};
  }
  RigidBody operator()(const BoxSurface& box) const {
    const double scale = box.half_sides.maxCoeff();
    return {shapes.find(box_at_origin(box.half_sides / scale)), scale, frame_of(box), {}};
  }
  RigidBody operator()(const TriangleSurface&) const {
    return body_of_triangles(name, {{surface_triangles(*object)}}, object->pose, accuracy, shapes);
  }
};

/// Returns the name of a group of bodies for messages.
std::string name_of(const ChargedBodies& bodies, const std::vector<std::size_t>& group) {
  const std::string& first = bodies.bodies[group.front()].name;
  return group.size() == 1 ? first : fmt::format("{} with what touches it", first);
}

/// Returns the surfaces of the bodies of a group that have triangles.
std::vector<TriangleSurface> surfaces_of(const ChargedBodies& bodies, const std::vector<std::size_t>& group) {
  std::vector<TriangleSurface> surfaces;
  for (const std::size_t part : group)
    if (const auto* surface = std::get_if<TriangleSurface>(&bodies.bodies[part].surface))
      surfaces.push_back(*surface);
  return surfaces;
}

}  // namespace

std::vector<Object> ordered_objects(const Scene& scene) {
  std::vector<Object> objects;
  for (const bool floating : {false, true})
    for (const Object& object : scene.objects)
      if (std::holds_alternative<Floating>(object.role) == floating)
        objects.push_back(object);
  return objects;
}

PreparedShape* SharedShapes::find(const FacedSurface& surface) {
  for (const auto& shape : shapes_)
    if (shape->has_faces_of(surface))
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(surface));
  return shapes_.back().get();
}

PreparedShape* SharedShapes::find(const std::vector<TriangleSurface>& surfaces, double accuracy) {
  const auto are_equal = [](const TriangleSurface& one, const TriangleSurface& other) {
    return one.triangles == other.triangles;
  };
  for (const auto& shape : shapes_)
    if (shape->mesh() != nullptr &&
        std::equal(surfaces.begin(), surfaces.end(), shape->mesh()->surfaces().begin(),
                   shape->mesh()->surfaces().end(), are_equal))
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(surfaces, accuracy));
  return shapes_.back().get();
}

void SharedShapes::forget_others(const std::vector<RigidBody>& bodies) {
  std::erase_if(shapes_, [&](const std::unique_ptr<PreparedShape>& shape) {
    return shape->mesh() != nullptr && shape->mesh()->surfaces().size() > 1 &&
           std::none_of(bodies.begin(), bodies.end(),
                        [&](const RigidBody& body) { return body.shape == shape.get(); });
  });
}

std::vector<RigidBody> rigid_bodies(const std::vector<Object>& objects, const ChargedBodies& bodies,
                                    const std::vector<std::vector<std::size_t>>& groups, double accuracy,
                                    SharedShapes& shapes) {
  for (const std::vector<std::size_t>& group : groups)
    refuse_large(name_of(bodies, group), surfaces_of(bodies, group));
  // The plates of sensors come before the objects.
  const std::size_t plates = bodies.bodies.size() - objects.size();
  std::vector<RigidBody> rigid;
  for (const std::vector<std::size_t>& group : groups) {
    const ChargedBody& first = bodies.bodies[group.front()];
    const Object* const object = group.front() < plates ? nullptr : &objects[group.front() - plates];
    rigid.push_back(group.size() == 1
                        ? std::visit(ShapeFinder{object, first.name, accuracy, shapes}, first.surface)
                        : body_of_triangles(name_of(bodies, group), surfaces_of(bodies, group),
                                            Eigen::Isometry3d::Identity(), accuracy, shapes));
    rigid.back().parts = group;
  }
  return rigid;
}

}  // namespace fringe::detail
