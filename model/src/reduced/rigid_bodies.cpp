#include "reduced/rigid_bodies.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "bem/box_self_interaction.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "reduced/prepared_mesh.hpp"
#include "reduced/single_body_system.hpp"
#include "surface/contact.hpp"

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
  for (const TriangleSurface& surface : surfaces)
    for (const Triangle& triangle : surface.triangles)
      for (const Vector3d& corner : triangle)
        box.extend(corner);
  const UnitSurfaces unit{{}, box.center(), box.sizes().maxCoeff() / 2};
  for (auto& [triangles, round] : surfaces) {
    for (Triangle& triangle : triangles)
      for (Vector3d& corner : triangle)
        corner = (corner - unit.centre) / unit.scale;
    if (round)
      round = round->in_unit(unit.centre, unit.scale);
  }
  return {std::move(surfaces), unit.centre, unit.scale};
}

/// Throws TooManyPanels for a body of more triangles than can be prepared.
void refuse_large(const std::string& name, const std::vector<TriangleSurface>& surfaces) {
  std::size_t triangles = 0;
  for (const TriangleSurface& surface : surfaces)
    triangles += surface.triangles.size();
  const std::size_t panels =
      triangles > most_mesh_panels ? triangles : std::max(triangles, panels_of(surfaces).panels().size());
  if (panels > most_mesh_panels)
    throw TooManyPanels(
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
    return body_of_triangles(name, {surface_of(*object)}, object->pose, accuracy, shapes);
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

/// Finds the shape of conductors with the dielectric bodies that touch them, or of such bodies alone. Sensors
/// with equal plates and covers share one: their triangles are put into the frame of the plate.
RigidBody body_with_insulators(const ChargedBodies& bodies, const std::vector<Insulator>& insulators,
                               const BodyGroup& group, double accuracy, SharedShapes& shapes) {
  // Such a body has less energy than the medium in its place; the basis is one of energies that are added.
  for (const std::size_t insulator : group.insulators)
    if (group.parts.empty() && insulators[insulator].ratio < 1)
      throw InputError(
          fmt::format("{}: its permittivity is lower than the medium's, which the reduced method "
                      "does not answer; boundary-elements do",
                      insulators[insulator].name));
  InsulatedBodies own;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  if (!group.parts.empty()) {
    own.conductors.conductors.push_back({"", Role::grounded, {}});
    if (const auto* plate = std::get_if<FlatPlate>(&bodies.bodies[group.parts.front()].surface))
      frame = frame_of(*plate);
  }
  std::vector<TriangleSurface> surfaces;
  for (const std::size_t part : group.parts)
    surfaces.push_back(oriented_triangles(bodies.bodies[part].surface));
  for (const std::size_t insulator : group.insulators)
    surfaces.push_back({insulators[insulator].surface, insulators[insulator].round});
  for (auto& [triangles, round] : surfaces) {
    for (Triangle& triangle : triangles)
      triangle = transformed(triangle, frame.inverse());
    if (round)
      round = round->moved(frame.inverse());
  }
  const UnitSurfaces unit = in_unit(std::move(surfaces));
  for (std::size_t k = 0; k < group.parts.size(); ++k)
    own.conductors.bodies.push_back({0, k, unit.surfaces[k], bodies.bodies[group.parts[k]].name, {}});
  for (std::size_t k = 0; k < group.insulators.size(); ++k) {
    Insulator& insulator = own.insulators.emplace_back(insulators[group.insulators[k]]);
    insulator.surface = unit.surfaces[group.parts.size() + k].triangles;
    insulator.round = unit.surfaces[group.parts.size() + k].round;
    insulator.box = axis_aligned_box(insulator.surface);
  }
  try {
    return {shapes.find(own, accuracy), unit.scale, frame * Eigen::Translation3d(unit.centre), {}};
  } catch (const InputError& error) {
    throw InputError(
        fmt::format("{}: {}", insulators[group.insulators.front()].name, std::string_view(error.what())));
  }
}

/// Returns true if two lists of triangles differ only by the rounding of poses, at a size of one.
bool have_equal_corners(std::span<const Triangle> one, std::span<const Triangle> other) {
  constexpr double rounding = 1e-9;
  if (one.size() != other.size())
    return false;
  for (std::size_t k = 0; k < one.size(); ++k)
    for (std::size_t corner = 0; corner < 3; ++corner)
      if ((one[k][corner] - other[k][corner]).norm() > rounding)
        return false;
  return true;
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
    return one.triangles == other.triangles && one.round.has_value() == other.round.has_value();
  };
  for (const auto& shape : shapes_)
    if (shape->mesh() != nullptr && shape->mesh()->ratios().empty() &&
        std::equal(surfaces.begin(), surfaces.end(), shape->mesh()->surfaces().begin(),
                   shape->mesh()->surfaces().end(), are_equal))
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(surfaces, accuracy));
  return shapes_.back().get();
}

PreparedShape* SharedShapes::find(const InsulatedBodies& bodies, double accuracy) {
  const auto are_alike = [&](const PreparedMesh& mesh) {
    const std::size_t conductors = bodies.conductors.bodies.size();
    if (mesh.surfaces().size() != conductors + bodies.insulators.size() ||
        mesh.ratios().size() != bodies.insulators.size())
      return false;
    for (std::size_t k = 0; k < mesh.surfaces().size(); ++k)
      if (!have_equal_corners(mesh.surfaces()[k].triangles,
                              k < conductors ? triangles_of(bodies.conductors.bodies[k].surface)
                                             : std::span(bodies.insulators[k - conductors].surface)) ||
          (k >= conductors && mesh.ratios()[k - conductors] != bodies.insulators[k - conductors].ratio))
        return false;
    return true;
  };
  for (const auto& shape : shapes_)
    if (shape->mesh() != nullptr && !shape->mesh()->ratios().empty() && are_alike(*shape->mesh()))
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(bodies, accuracy));
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
                                    const std::vector<Insulator>& insulators,
                                    const std::vector<BodyGroup>& groups, double accuracy,
                                    SharedShapes& shapes) {
  for (const BodyGroup& group : groups)
    if (!group.parts.empty())
      refuse_large(name_of(bodies, group.parts), surfaces_of(bodies, group.parts));
  // The plates of sensors come before the objects.
  const std::size_t plates = bodies.bodies.size() - objects.size();
  std::vector<RigidBody> rigid;
  for (const BodyGroup& group : groups) {
    if (!group.insulators.empty()) {
      rigid.push_back(body_with_insulators(bodies, insulators, group, accuracy, shapes));
    } else {
      const ChargedBody& first = bodies.bodies[group.parts.front()];
      const Object* const object =
          group.parts.front() < plates ? nullptr : &objects[group.parts.front() - plates];
      rigid.push_back(group.parts.size() == 1
                          ? std::visit(ShapeFinder{object, first.name, accuracy, shapes}, first.surface)
                          : body_of_triangles(name_of(bodies, group.parts), surfaces_of(bodies, group.parts),
                                              Eigen::Isometry3d::Identity(), accuracy, shapes));
    }
    rigid.back().parts = group.parts;
    rigid.back().insulators = group.insulators;
  }
  return rigid;
}

}  // namespace fringe::detail
