#pragma once

#include <array>
#include <vector>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"
#include "multiprecision.hpp"

/// A triangle cut up for quadrature, in 50 digits, from the input doubles as they are.
namespace fringe::stress {

/// A plate's own coordinates: the origin in its corner, x along edge_u, z along the normal, y = z × x.
struct ExactFrame {
  RealVector corner;
  std::array<RealVector, 3> axes;
  std::array<Real, 2> lengths;
};

ExactFrame exact_frame(const Rectangle& plate);

/// A point of the triangle. All three vectors are linear functions of it within a sector.
struct Point {
  RealVector position;     ///< in the plate's coordinates
  RealVector barycentric;  ///< in the whole triangle
  RealVector from_plate;   ///< to it from the nearest point of the plate
};

Point between(const Point& a, const Point& b, const Real& share);

/// A triangle within one of the nine cells. Of the points of the cut-up triangle in that cell, `apex` is the
/// one nearest to the plate; along the edge from `start` to `end` the distance grows.
struct Sector {
  Point apex, start, end;
};

/// A triangle cut up.
struct Dissection {
  ExactFrame frame;
  std::array<RealVector, 3> vertices;  ///< in the plate's coordinates
  Real twice_area;
  bool divergent = false;  ///< the triangle meets the plate along a segment
  std::vector<Sector> sectors;
};

Dissection dissect(const Triangle& triangle, const Rectangle& plate);

Real twice_area(const RealVector& a, const RealVector& b, const RealVector& c);

}  // namespace fringe::stress
