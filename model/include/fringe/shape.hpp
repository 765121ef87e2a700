#pragma once

#include <filesystem>
#include <variant>
#include <vector>

#include "fringe/triangle.hpp"

/// The shapes of a scene (geometries/SCENE.md), each in its own frame: centred at the origin, with z as its
/// axis, in metres.
namespace fringe {

/// A one-sided rectangle in z = 0: each of its points counts once.
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

/// A triangle mesh read from a file, already scaled.
struct Mesh {
  std::filesystem::path file;
  double scale;
  std::vector<Triangle> triangles;
};

using Shape = std::variant<Plate, Cuboid, Cylinder, Cone, Arc, Sphere, Mesh>;

}  // namespace fringe
