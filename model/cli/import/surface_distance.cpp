#include "import/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Extrema_GenLocateExtPS.hxx>
#include <Precision.hxx>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

namespace fringe::cli {
namespace {

/// Returns the distance of a point from an axis, and its height along it.
std::pair<double, double> about_axis(const gp_Pnt& point, const gp_Ax3& axes) {
  const gp_XYZ from_origin = point.XYZ() - axes.Location().XYZ();
  const double height = from_origin * axes.Direction().XYZ();
  return {(from_origin - height * axes.Direction().XYZ()).Modulus(), height};
}

double from_cone(const gp_Pnt& point, const gp_Cone& cone) {
  const auto [radius, height] = about_axis(point, cone.Position());
  const double slope = std::sin(cone.SemiAngle()), along = std::cos(cone.SemiAngle());
  // The surface goes on beyond its apex, on the other side of the axis.
  return std::min(std::abs((radius - cone.RefRadius()) * along - height * slope),
                  std::abs((-radius - cone.RefRadius()) * along - height * slope));
}

double from_torus(const gp_Pnt& point, const gp_Torus& torus) {
  const auto [radius, height] = about_axis(point, torus.Position());
  return std::abs(std::hypot(radius - torus.MajorRadius(), height) - torus.MinorRadius());
}

}  // namespace

double SurfaceDistance::of(const gp_Pnt& point, const std::array<gp_Pnt2d, 3>& corners) const {
  switch (surface_.GetType()) {
  case GeomAbs_Plane:
    return surface_.Plane().Distance(point);
  case GeomAbs_Cylinder:
    return std::abs(about_axis(point, surface_.Cylinder().Position()).first - surface_.Cylinder().Radius());
  case GeomAbs_Cone:
    return from_cone(point, surface_.Cone());
  case GeomAbs_Sphere:
    return std::abs(point.Distance(surface_.Sphere().Location()) - surface_.Sphere().Radius());
  case GeomAbs_Torus:
    return from_torus(point, surface_.Torus());
  default:
    break;
  }
  double least = from(point, (corners[0].XY() + corners[1].XY() + corners[2].XY()) / 3);
  for (const gp_Pnt2d& corner : corners) {
    if (least <= enough_)
      break;
    least = std::min(least, from(point, corner.XY()));
  }
  return least;
}

/// Minimises the distance from a place on the surface.
double SurfaceDistance::from(const gp_Pnt& point, const gp_XY& start) const {
  // Every place on the surface gives an upper bound of the distance.
  const double bound = point.Distance(surface_.Value(start.X(), start.Y()));
  if (bound <= enough_)
    return bound;
  Extrema_GenLocateExtPS nearest(surface_, Precision::PConfusion(), Precision::PConfusion());
  nearest.Perform(point, start.X(), start.Y(), true);
  return nearest.IsDone() ? std::min(bound, std::sqrt(nearest.SquareDistance())) : bound;
}

}  // namespace fringe::cli
