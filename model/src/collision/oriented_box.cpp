#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "collision/box_axes.hpp"
#include "collision/scaled_points.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/error.hpp"

namespace fringe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void check(std::span<const Face> faces, std::size_t vertices) {
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const std::size_t vertex : faces[i])
      if (vertex >= vertices)
        throw InputError(fmt::format("face {} names vertex {}; there are {} vertices", i, vertex, vertices));
}

/// Makes the rows orthonormal up to rounding and right-handed; they must be so already up to sign and small
/// errors.
Matrix3d right_handed(const Matrix3d& axes) {
  Matrix3d result;
  const Vector3d first = axes.row(0).normalized();
  const Vector3d second = (axes.row(1).transpose() - axes.row(1).dot(first) * first).normalized();
  result << first.transpose(), second.transpose(), first.cross(second).transpose();
  return result;
}

Matrix3d axes_by(BoxMethod method, const std::vector<Vector3d>& points, std::span<const Face> faces) {
  switch (method) {
  case BoxMethod::vertices:
    return detail::axes_of_vertices(points);
  case BoxMethod::triangles:
    return detail::axes_of_triangles(points, faces);
  case BoxMethod::tight:
    return detail::tight_axes(points, faces);
  }
  throw InputError("unknown method for an oriented box");
}

/// Returns the centre of the points' extent along the axes.
Vector3d middle_along(const Matrix3d& axes, const std::vector<Vector3d>& points, const Vector3d& from) {
  Vector3d lowest = Vector3d::Constant(std::numeric_limits<double>::infinity()), highest = -lowest;
  for (const Vector3d& point : points) {
    const Vector3d along = axes * (point - from);
    lowest = lowest.cwiseMin(along);
    highest = highest.cwiseMax(along);
  }
  return from + axes.transpose() * ((lowest + highest) / 2);
}

}  // namespace

BoxMethod parse_box_method(std::string_view text) {
  if (text == "vertices")
    return BoxMethod::vertices;
  if (text == "triangles")
    return BoxMethod::triangles;
  if (text == "tight")
    return BoxMethod::tight;
  throw InputError(
      fmt::format("unknown method '{}' for an oriented box: use vertices, triangles or tight", text));
}

OrientedBox oriented_box(std::span<const Vector3d> vertices, std::span<const Face> faces, BoxMethod method) {
  const auto [points, middle, exponent] = detail::scaled_points(vertices);
  check(faces, points.size());
  const Matrix3d axes = right_handed(axes_by(method, points, faces));
  const Vector3d centre = middle_along(axes, points, middle);
  Vector3d half_widths = Vector3d::Zero();
  double farthest = 0;
  for (const Vector3d& point : points) {
    const Vector3d offset = point - centre;
    half_widths = half_widths.cwiseMax((axes * offset).cwiseAbs());
    farthest = std::max(farthest, offset.norm());
  }
  // Four roundings stand between a coordinate and a height, and the axes are orthonormal to a few more. The
  // margin is twice that, so that a height computed anew by a caller is still inside.
  const double outward = 8 * std::numeric_limits<double>::epsilon() * farthest;
  // The absolute error that the centre and the half-widths can have in the subnormal range.
  constexpr double smallest = 4 * std::numeric_limits<double>::denorm_min();
  const auto in_given_unit = [e = exponent](double x) { return std::ldexp(x, e); };
  return {centre.unaryExpr(in_given_unit), axes,
          (half_widths.array() + outward).unaryExpr(in_given_unit) + smallest};
}

}  // namespace fringe
