#pragma once

#include <filesystem>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

/// The shapes of a scene (geometries/SCENE.md), each in its own frame: centred at the origin, with z as its
/// axis, in metres.
namespace fringe {

/// A rectangle in z = 0: each of its points counts once.
struct Plate {
  double size_x;
  double size_y;
};

/// A box; a cube has three equal sizes.
struct Cuboid {
  double size_x;
  double size_y;
  double size_z;
};

struct Cylinder {
  double radius;
  double height;
  int segments;
};

/// The base lies at z = −height/2, the apex at +height/2.
struct Cone {
  double radius;
  double height;
  int segments;
};

/// A sector of a ring about z, from −degrees/2 to +degrees/2.
struct Arc {
  double inner_radius;
  double outer_radius;
  double height;
  double degrees;
  int segments;
};

struct Sphere {
  double radius;
  int segments;
};

struct Ellipsoid {
  double semi_axis_x;
  double semi_axis_y;
  double semi_axis_z;
  int segments;
};

/// A segment along z swept by a ball. `length` is that of the segment, without the half balls at its ends.
struct Capsule {
  double radius;
  double length;
  int segments;
};

/// A box with these outer sizes whose edges and corners are round: a smaller box swept by a ball of radius
/// `rounding`, which is at most half the smallest size.
struct RoundedCuboid {
  double size_x;
  double size_y;
  double size_z;
  double rounding;
  int segments;
};

/// A disc in z = 0: each of its points counts once.
struct Disc {
  double radius;
  int segments;
};

/// A simple polygon in z = 0, each of whose points counts once, its vertices in either order.
struct Polygon {
  std::vector<Eigen::Vector2d> vertices;
};

/// A triangle mesh read from a file, already scaled; or the surface of a person, which has no file.
struct Mesh {
  std::filesystem::path file;
  double scale;
  std::vector<Triangle> triangles;
};

using Shape = std::variant<Plate, Cuboid, Cylinder, Cone, Arc, Sphere, Mesh, Ellipsoid, Capsule,
                           RoundedCuboid, Disc, Polygon>;

/// Returns half the sizes of the segment or box that a ball sweeps; 0 where it has no length.
inline Eigen::Vector3d core_of(const Capsule& capsule) {
  return {0, 0, capsule.length / 2};
}
inline Eigen::Vector3d core_of(const RoundedCuboid& cuboid) {
  return {cuboid.size_x / 2 - cuboid.rounding, cuboid.size_y / 2 - cuboid.rounding,
          cuboid.size_z / 2 - cuboid.rounding};
}

}  // namespace fringe
