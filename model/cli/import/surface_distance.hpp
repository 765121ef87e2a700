#pragma once

#include <array>

#include <BRepAdaptor_Surface.hxx>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>

namespace fringe::cli {

/// Finds the distances of points from the surface of a face, whose outline is not regarded.
class SurfaceDistance {
 public:
  /// A distance that is at most `enough` is not looked for any closer, in the unit of the surface.
  SurfaceDistance(const BRepAdaptor_Surface& surface, double enough) : surface_(surface), enough_(enough) {}

  /// Returns the distance of a point of a triangle from the surface: exactly for planes, cylinders, cones,
  /// spheres and tori, otherwise by minimising it from the parameters of the triangle's corners and their
  /// mean.
  double of(const gp_Pnt& point, const std::array<gp_Pnt2d, 3>& corners) const;

 private:
  double from(const gp_Pnt& point, const gp_XY& start) const;

  const BRepAdaptor_Surface& surface_;
  double enough_;
};

}  // namespace fringe::cli
