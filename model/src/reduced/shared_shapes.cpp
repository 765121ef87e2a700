#include "reduced/shared_shapes.hpp"

#include "bem/box_self_interaction.hpp"
#include "reduced/prepared_mesh.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

std::vector<ChargedFace> faces_of(std::size_t count, const Vector3d& half_sides) {
  if (count == 1)
    return {{Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY(), half_sides.x(), half_sides.y(),
             EdgeKind::thin}};
  const auto faces = faces_of_box(half_sides);
  return {faces.begin(), faces.end()};
}

}  // namespace

PreparedShape* SharedShapes::find(std::size_t faces, const Vector3d& half_sides) {
  for (const auto& shape : shapes_)
    if (shape->faces().size() == faces && shape->half_sides() == half_sides)
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(faces_of(faces, half_sides), half_sides));
  return shapes_.back().get();
}

PreparedShape* SharedShapes::find(const std::vector<Triangle>& triangles, double accuracy) {
  for (const auto& shape : shapes_)
    if (shape->mesh() != nullptr && shape->mesh()->triangles() == triangles)
      return shape.get();
  shapes_.push_back(std::make_unique<PreparedShape>(triangles, accuracy));
  return shapes_.back().get();
}

}  // namespace fringe::detail
