#include "resolution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <boost/math/tools/minima.hpp>

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

struct Segment {
  Vector3d from;
  Vector3d to;
};

/// The edges of a face; those of a box come twice.
std::array<Segment, 4> edges_of(const Face& face) {
  const Vector3d u = face.half_u * face.axis_u, v = face.half_v * face.axis_v;
  const Vector3d corners[]{face.centre - u - v, face.centre + u - v, face.centre + u + v,
                           face.centre - u + v};
  return {{{corners[0], corners[1]},
           {corners[1], corners[2]},
           {corners[2], corners[3]},
           {corners[3], corners[0]}}};
}

/// What the charges of a body end at or bend around: the edges of its faces, or the sides of its triangles.
std::vector<Segment> edges_of(const ChargedBody& body) {
  std::vector<Segment> edges;
  for (const Face& face : body.faces)
    for (const Segment& edge : edges_of(face))
      edges.push_back(edge);
  for (const Triangle& triangle : body.triangles)
    for (std::size_t corner = 0; corner < 3; ++corner)
      edges.push_back({triangle[corner], triangle[(corner + 1) % 3]});
  return edges;
}

/// The logarithm of the parameter of the narrowest ellipse, with the ends of one direction of a face as foci,
/// that a segment touches. The potential of what is beyond it is analytic inside. A line that meets the
/// direction at an angle is seen as from so much farther away as its distance changes more slowly; of a
/// parallel one only the ends are seen.
double log_parameter(const Segment& segment, const Face& face, const Vector3d& along, double half_along,
                     const Vector3d& across, double half_across) {
  const Vector3d normal = face.axis_u.cross(face.axis_v);
  const auto coordinates = [&](const Vector3d& point) {
    const Vector3d offset = (point - face.centre) / half_along;
    return Vector3d(offset.dot(along), offset.dot(across), offset.dot(normal));
  };
  const Vector3d from = coordinates(segment.from), way = coordinates(segment.to) - from;
  const double width = half_across / half_along, sine = std::hypot(way.y(), way.z()) / way.norm();
  // The sum of the distances from the foci: convex along the segment.
  const auto sum = [&](double part, double slowness) {
    const Vector3d point = from + part * way;
    const double height = std::hypot(point.z(), std::max(std::abs(point.y()) - width, 0.0)) / slowness;
    return std::hypot(point.x() - 1, height) + std::hypot(point.x() + 1, height);
  };
  double least = std::min(sum(0, 1), sum(1, 1));
  /// Below, what lies between the ends is seen from as far as if it were not there.
  constexpr double parallel = 1e-3;
  /// The logarithm decides how many functions there are: three digits are plenty.
  constexpr int bits = 10;
  if (sine > parallel)
    least = std::min(least, boost::math::tools::brent_find_minima(
                                [&](double part) { return sum(part, sine); }, 0.0, 1.0, bits)
                                .second);
  return std::acosh(std::max(least / 2, 1.0));
}

int functions_for(double parameter, double features, int least) {
  if (!(features < parameter * most_functions))
    return most_functions;
  const int wanted = static_cast<int>(std::ceil(1 + features / parameter)) | 1;
  return std::clamp(wanted, least, most_functions);
}

}  // namespace

std::vector<FaceFunctions> resolving_functions(const ChargedBodies& bodies, double features, int least) {
  std::vector<FaceFunctions> functions;
  for (const ChargedBody& body : bodies.bodies)
    for (const Face& face : body.faces) {
      double along_u = std::numeric_limits<double>::infinity(), along_v = along_u;
      for (const ChargedBody& other : bodies.bodies) {
        if (&other == &body)
          continue;
        for (const Segment& edge : edges_of(other)) {
          along_u = std::min(along_u,
                             log_parameter(edge, face, face.axis_u, face.half_u, face.axis_v, face.half_v));
          along_v = std::min(along_v,
                             log_parameter(edge, face, face.axis_v, face.half_v, face.axis_u, face.half_u));
        }
      }
      functions.push_back({functions_for(along_u, features, least), functions_for(along_v, features, least)});
    }
  return functions;
}

}  // namespace fringe::detail
