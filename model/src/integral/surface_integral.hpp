#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/capacitance.hpp"
#include "fringe/rectangle.hpp"
#include "fringe/surface_tree.hpp"
#include "fringe/triangle_batch.hpp"
#include "geometry/plate_frame.hpp"

/// ∫dA/d over the surface of one object for the plates of one sensor, all in the object's own frame.
namespace fringe::detail {

/// An object's surface, prepared once.
struct Surface {
  std::vector<Triangle> triangles;
  TriangleBatch batch;
  std::optional<SurfaceTree> tree;  ///< made when the surface is integrated over and over
  Eigen::Vector3d centroid;         ///< of the area
  double radius;                    ///< of a sphere about the centroid that holds the surface
  double area;
  double squared_radius_moment;  ///< ∫|p − centroid|² dA
};

/// @throws InputError when a vertex is not finite.
Surface make_surface(std::vector<Triangle> triangles);

struct SurfaceIntegral {
  double value = 0;  ///< m; +infinity on contact
  double bound = 0;  ///< m; what was left out on purpose, at most
  bool skipped = false;
  EvaluationCounts counts;
};

/// Between which two values the sum over the plates lies, from the surface's sphere alone. The upper one is
/// infinite when the sphere meets a plate.
struct Enclosure {
  double lower = 0;
  double upper = 0;
};
Enclosure enclosure(const Surface& surface, const Eigen::Vector3d& centroid,
                    std::span<const PlateFrame> plates);

/// @param options what counts and how it is integrated; the bound is at most tolerance·value + allowance
SurfaceIntegral surface_integral(const Surface& surface, std::span<const Rectangle> plates,
                                 const CapacitanceOptions& options, double allowance);

}  // namespace fringe::detail
