#include "geometry/plate_frame.hpp"

#include <cmath>

#include "numeric/compensated.hpp"

namespace fringe::detail {
namespace {

struct DirectionAndLength {
  Eigen::Vector3d direction;
  double length;
};

/// Direction and length of an edge, exact when it lies along an axis: a triangle may touch the plate's far
/// edges exactly. Scaled by a power of two, so that no square overflows or vanishes.
DirectionAndLength polar(const Eigen::Vector3d& edge) {
  const int exponent = std::ilogb(edge.lpNorm<Eigen::Infinity>());
  const Eigen::Vector3d scaled = edge.unaryExpr([=](double x) { return std::ldexp(x, -exponent); });
  const double length = scaled.norm();
  return {scaled / length, std::ldexp(length, exponent)};
}

}  // namespace

PlateFrame plate_frame(const Rectangle& plate) {
  const auto [along_u, length_u] = polar(plate.edge_u);
  const auto [along_v, length_v] = polar(plate.edge_v);
  PlateFrame frame;
  frame.corner = plate.corner;
  frame.length_u = length_u;
  frame.length_v = length_v;
  const Eigen::Vector3d normal = cross(along_u, along_v).normalized();
  frame.axes.row(0) = along_u;
  // From the normal, not from edge_v: the three axes are then orthogonal to rounding whatever the edges' own
  // error.
  frame.axes.row(1) = cross(normal, along_u);
  frame.axes.row(2) = normal;
  return frame;
}

LocalTriangle to_local(const PlateFrame& plate, const Triangle& triangle) {
  return {plate.axes * (triangle[0] - plate.corner), plate.axes * (triangle[1] - plate.corner),
          plate.axes * (triangle[2] - plate.corner)};
}

}  // namespace fringe::detail
