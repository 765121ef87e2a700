#include "geometry/plate_frame.hpp"

#include <cmath>

#include "numeric/compensated.hpp"

namespace fringe::detail {
namespace {

struct DirectionAndLength {
  Eigen::Vector3d direction;
  double length;
};

/// Computes direction and length of an edge. Both are exact when the edge lies along an axis, because a
/// triangle may touch the plate's far edges exactly. Scales by a power of two, so that no square overflows or
/// underflows.
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
  // Computed from the normal instead of edge_v: the three axes are then orthogonal up to rounding even if the
  // edges are not.
  frame.axes.row(1) = cross(normal, along_u);
  frame.axes.row(2) = normal;
  return frame;
}

LocalTriangle to_local(const PlateFrame& plate, const Triangle& triangle) {
  return {plate.axes * (triangle[0] - plate.corner), plate.axes * (triangle[1] - plate.corner),
          plate.axes * (triangle[2] - plate.corner)};
}

}  // namespace fringe::detail
