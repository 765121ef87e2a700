#pragma once

#include <array>
#include <vector>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"
#include "multiprecision.hpp"

/// Dissection of a triangle into sectors for quadrature, in 50 digits and without rounding the input.
namespace fringe::stress {

/// A plate's own coordinate system: the origin at its corner, x along edge_u, z along the normal, y = z × x.
struct ExactFrame {
  RealVector corner;
  std::array<RealVector, 3> axes;
  std::array<Real, 2> lengths;
};

ExactFrame exact_frame(const Rectangle& plate);

/// A point of the triangle. Within a sector all three vectors are affine functions of the point.
struct Point {
  RealVector position;     ///< in the plate's coordinates
  RealVector barycentric;  ///< in the whole triangle
  RealVector from_plate;   ///< to it from the nearest point of the plate
};

Point between(const Point& a, const Point& b, const Real& share);

/// A triangle within one of the nine cells. `apex` is the point nearest to the plate of the part of the
/// dissected triangle in that cell; along the edge from `start` to `end` the distance increases.
struct Sector {
  Point apex, start, end;
};

/// A triangle divided into sectors.
struct Dissection {
  ExactFrame frame;
  std::array<RealVector, 3> vertices;  ///< in the plate's coordinates
  Real twice_area;
  bool divergent = false;  ///< the triangle meets the plate along a segment
  std::vector<Sector> sectors;
};

/// Cuts a triangle at the plate's border planes and divides the pieces into sectors.
Dissection dissect(const Triangle& triangle, const Rectangle& plate);

Real twice_area(const RealVector& a, const RealVector& b, const RealVector& c);

}  // namespace fringe::stress
