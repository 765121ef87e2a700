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
#include "geometry/wrench.hpp"

/// Integrals ∫dA/d over the surface of one object for the plates of one sensor, all in the object's own
/// frame.
namespace fringe::detail {

/// How a surface is integrated: what EvaluationOptions say of it.
struct IntegralOptions {
  Method method;  ///< one that integrates over triangles, or the pair formula in their place
  PlateRule plates;
  FaceRule faces;
  double tolerance;
};

/// An object's surface with the quantities that all of its integrals share.
struct Surface {
  std::vector<Triangle> triangles;
  TriangleBatch batch;
  std::optional<SurfaceTree> tree;  ///< present when the surface is integrated repeatedly
  Eigen::Vector3d centroid;         ///< centroid of the area
  double radius;                    ///< radius of a sphere about the centroid that contains the surface
  double area;
  double squared_radius_moment;  ///< ∫|p − centroid|² dA
};

/// Computes area, centroid, radius and moment of a surface. Throws InputError when a vertex is not finite.
Surface make_surface(std::vector<Triangle> triangles);

struct SurfaceIntegral {
  double value = 0;  ///< m; +infinity on contact
  double bound = 0;  ///< m; upper bound of the error accepted on purpose, rounding not included
  bool skipped = false;
  EvaluationCounts counts;
};

/// Lower and upper bound of the sum of the integrals over the plates, from the surface's bounding sphere
/// alone. The upper bound is infinite when the sphere meets a plate.
struct Enclosure {
  double lower = 0;
  double upper = 0;
};
Enclosure enclosure(const Surface& surface, const Eigen::Vector3d& centroid,
                    std::span<const PlateFrame> plates);

/// Computes the sum over the plates of ∫dA/d, or ∫dA/min_k d_k, as the options ask. The bound of the result
/// is at most tolerance·value + allowance.
SurfaceIntegral surface_integral(const Surface& surface, std::span<const Rectangle> plates,
                                 const IntegralOptions& options, double allowance);

/// Computes the derivatives of the integral by the method exact as the surface moves and the plates stay, in
/// the surface's frame. The triangles that count, and where several plates are equally near, stay the same.
/// All are NaN in contact. The tolerance does not apply.
Wrench surface_wrench(const Surface& surface, std::span<const Rectangle> plates,
                      const IntegralOptions& options);

}  // namespace fringe::detail
