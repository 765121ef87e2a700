#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fringe/scene.hpp"
#include "fringe/triangle.hpp"

/// The scenes and bodies on which boundary elements are timed as users meet them.
namespace fringe::benchmarks {

struct TimedScene {
  std::string name;
  Scene scene;
  double rtol;
  std::optional<double> most_seconds = {};  ///< after which the best answer so far counts
};

/// Returns scenes from two plates to a whole machine.
std::vector<TimedScene> timed_scenes();

/// A regular polyhedron with edges of 1 m around the origin.
struct Solid {
  std::string name;
  std::vector<Triangle> triangles;
  std::optional<double> published;  ///< capacity in units of 4πε₀ times the edge
};

/// Returns the five regular polyhedra.
std::vector<Solid> regular_polyhedra();

/// Divides each side of an icosahedron's triangles into `parts` and moves the points to a sphere of radius
/// 1 m: 20·parts² triangles of nearly one size.
std::vector<Triangle> geodesic_sphere(int parts);

/// Returns a scene with one isolated electrode.
Scene isolated(const Shape& shape);

}  // namespace fringe::benchmarks
