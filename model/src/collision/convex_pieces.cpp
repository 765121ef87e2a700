#include "collision/convex_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "fringe/triangle.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Relative margin of boxes: covers the rounding errors of sizes, sines and cosines.
constexpr double outwards = 0x1p-48;

AlignedBox3d enlarged(const AlignedBox3d& box) {
  const double margin = outwards * std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  return {box.min() - Vector3d::Constant(margin), box.max() + Vector3d::Constant(margin)};
}

AlignedBox3d centred_box(double x, double y, double z) {
  return enlarged({Vector3d(-x, -y, -z), Vector3d(x, y, z)});
}

/// Computes a box around the sector of a ring from −half to +half (radians).
AlignedBox3d sector_box(double inner, double outer, double height, double half) {
  constexpr double quarter = std::numbers::pi / 2;
  const double low_x = std::cos(half) * (half > quarter ? outer : inner);
  const double y = half > quarter ? outer : outer * std::sin(half);
  return enlarged({Vector3d(low_x, -y, -height / 2), Vector3d(outer, y, height / 2)});
}

AlignedBox3d box_of(const Plate& plate) {
  return centred_box(plate.size_x / 2, plate.size_y / 2, 0);
}

AlignedBox3d box_of(const Cuboid& cuboid) {
  return centred_box(cuboid.size_x / 2, cuboid.size_y / 2, cuboid.size_z / 2);
}

AlignedBox3d box_of(const Cylinder& cylinder) {
  return centred_box(cylinder.radius, cylinder.radius, cylinder.height / 2);
}

AlignedBox3d box_of(const Cone& cone) {
  return centred_box(cone.radius, cone.radius, cone.height / 2);
}

AlignedBox3d box_of(const Sphere& sphere) {
  return centred_box(sphere.radius, sphere.radius, sphere.radius);
}

AlignedBox3d box_of(const Ellipsoid& ellipsoid) {
  return centred_box(ellipsoid.semi_axis_x, ellipsoid.semi_axis_y, ellipsoid.semi_axis_z);
}

AlignedBox3d box_of(const Capsule& capsule) {
  return centred_box(capsule.radius, capsule.radius, capsule.length / 2 + capsule.radius);
}

AlignedBox3d box_of(const RoundedCuboid& cuboid) {
  return centred_box(cuboid.size_x / 2, cuboid.size_y / 2, cuboid.size_z / 2);
}

AlignedBox3d box_of(const Disc& disc) {
  return centred_box(disc.radius, disc.radius, 0);
}

AlignedBox3d box_of(const Polygon& polygon) {
  AlignedBox3d box;
  for (const Eigen::Vector2d& vertex : polygon.vertices)
    box.extend(Vector3d(vertex.x(), vertex.y(), 0));
  return enlarged(box);
}

AlignedBox3d box_of(const Arc& arc) {
  return sector_box(arc.inner_radius, arc.outer_radius, arc.height, arc.degrees / 2 * std::numbers::pi / 180);
}

template <typename Primitive>
OrientedBox enclosing_box_of(const Primitive& primitive) {
  const AlignedBox3d box = box_of(primitive);
  return {box.center(), Eigen::Matrix3d::Identity(), enlarged(box).sizes() / 2};
}

OrientedBox enclosing_box_of(const Mesh& mesh) {
  std::vector<Vector3d> vertices;
  std::vector<Face> faces;
  for (const Triangle& triangle : mesh.triangles) {
    faces.push_back({vertices.size(), vertices.size() + 1, vertices.size() + 2});
    vertices.insert(vertices.end(), triangle.begin(), triangle.end());
  }
  return oriented_box(vertices, faces, BoxMethod::tight);
}

ConvexShape convex_shape_of(const Plate& plate) {
  return ConvexShape::cuboid({plate.size_x, plate.size_y, 0});
}

ConvexShape convex_shape_of(const Cuboid& cuboid) {
  return ConvexShape::cuboid({cuboid.size_x, cuboid.size_y, cuboid.size_z});
}

ConvexShape convex_shape_of(const Cylinder& cylinder) {
  return ConvexShape::cylinder(cylinder.radius, cylinder.height);
}

ConvexShape convex_shape_of(const Cone& cone) {
  return ConvexShape::cone(cone.radius, cone.height);
}

ConvexShape convex_shape_of(const Sphere& sphere) {
  return ConvexShape::ball(sphere.radius);
}

ConvexShape convex_shape_of(const Ellipsoid& ellipsoid) {
  return ConvexShape::ellipsoid({ellipsoid.semi_axis_x, ellipsoid.semi_axis_y, ellipsoid.semi_axis_z});
}

ConvexShape convex_shape_of(const Capsule& capsule) {
  return ConvexShape::rounded_cuboid(2 * core_of(capsule), capsule.radius);
}

ConvexShape convex_shape_of(const RoundedCuboid& cuboid) {
  return ConvexShape::rounded_cuboid(2 * core_of(cuboid), cuboid.rounding);
}

ConvexShape convex_shape_of(const Disc& disc) {
  return ConvexShape::cylinder(disc.radius, 0);
}

/// Takes a convex shape as one piece.
template <typename Convex>
ConvexPieces pieces_of(const Convex& convex) {
  const AlignedBox3d box = box_of(convex);
  return {{{convex_shape_of(convex)}}, BoxTree({&box, 1})};
}

ConvexPieces pieces_of(const Arc& arc) {
  // Largest angle of a piece in degrees; a convex piece must be less than half a turn.
  constexpr double most_degrees = 120;
  const int count = std::max(arc.segments, static_cast<int>(std::ceil(arc.degrees / most_degrees)));
  const double degrees = arc.degrees / count;
  const double radians = degrees * std::numbers::pi / 180;
  const ConvexShape shape = ConvexShape::arc_piece(arc.inner_radius, arc.outer_radius, arc.height, degrees);
  const AlignedBox3d own_box = sector_box(arc.inner_radius, arc.outer_radius, arc.height, radians / 2);
  ConvexPieces pieces;
  std::vector<AlignedBox3d> boxes;
  for (int k = 0; k < count; ++k) {
    const double angle = (k + 0.5 - count / 2.0) * radians;
    const Isometry3d pose(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
    pieces.pieces.push_back({shape, pose});
    boxes.push_back(enlarged(own_box.transformed(pose)));
  }
  pieces.tree = BoxTree(boxes);
  return pieces;
}

/// Takes every triangle as a piece.
ConvexPieces pieces_of(const std::vector<Triangle>& triangles) {
  ConvexPieces pieces;
  std::vector<AlignedBox3d> boxes;
  for (const Triangle& triangle : triangles) {
    pieces.pieces.push_back({ConvexShape::hull(triangle)});
    boxes.push_back(axis_aligned_box(triangle));
  }
  pieces.tree = BoxTree(boxes);
  return pieces;
}

ConvexPieces pieces_of(const Mesh& mesh) {
  ConvexPieces pieces = pieces_of(mesh.triangles);
  pieces.bounds_volume = is_closed(mesh.triangles);
  return pieces;
}

ConvexPieces pieces_of(const Polygon& polygon) {
  return pieces_of(triangulate(polygon));
}

}  // namespace

OrientedBox enclosing_box(const Shape& shape) {
  return std::visit([](const auto& kind) { return enclosing_box_of(kind); }, shape);
}

BoundingSphere ball_around_box(const Mesh& mesh) {
  /// Factor between the radii, more than √3: along none of its axes is the box wider than a ball around the
  /// triangles.
  constexpr double box_in_ball = 1.74;
  AlignedBox3d box;
  for (const Triangle& triangle : mesh.triangles)
    box.extend(axis_aligned_box(std::span<const Vector3d>(triangle)));
  box = enlarged(box);
  return {box.center(), box_in_ball * box.diagonal().stableNorm() / 2};
}

ConvexPieces convex_pieces(const Shape& shape) {
  return std::visit([](const auto& kind) { return pieces_of(kind); }, shape);
}

}  // namespace fringe::detail
