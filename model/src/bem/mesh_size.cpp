#include "bem/mesh_size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <boost/math/tools/minima.hpp>

#include "bem/proximity_refinement.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

struct Segment {
  Vector3d from;
  Vector3d to;
};

/// Returns the edges of a face. Each edge of a box belongs to two faces.
std::array<Segment, 4> edges_of(const ChargedFace& face) {
  const std::array<Vector3d, 4> corners = corners_of(face);
  return {{{corners[0], corners[1]},
           {corners[1], corners[2]},
           {corners[2], corners[3]},
           {corners[3], corners[0]}}};
}

/// Returns the edges at which a body's charge ends or bends: those of its faces, or the sides of its
/// triangles.
std::vector<Segment> edges_of(const ChargedBody& body) {
  std::vector<Segment> edges;
  for (const ChargedFace& face : faces_of(body.surface))
    for (const Segment& edge : edges_of(face))
      edges.push_back(edge);
  for (const Triangle& triangle : triangles_of(body.surface))
    for (std::size_t corner = 0; corner < 3; ++corner)
      edges.push_back({triangle[corner], triangle[(corner + 1) % 3]});
  return edges;
}

/// Returns the logarithm of the parameter of the narrowest ellipse that a segment touches, with the ends of
/// one direction of a face as foci. Inside it the potential of what is beyond is analytic. The distance of a
/// line at an angle to the direction is divided by the sine of the angle, because it changes more slowly
/// along the direction; of a parallel line only the ends count.
double log_parameter(const Segment& segment, const ChargedFace& face, const Vector3d& along,
                     double half_along, const Vector3d& across, double half_across) {
  const Vector3d normal = face.axis_u.cross(face.axis_v);
  const auto coordinates = [&](const Vector3d& point) {
    const Vector3d offset = (point - face.centre) / half_along;
    return Vector3d(offset.dot(along), offset.dot(across), offset.dot(normal));
  };
  const Vector3d from = coordinates(segment.from), way = coordinates(segment.to) - from;
  const double width = half_across / half_along, sine = std::hypot(way.y(), way.z()) / way.norm();
  // Sum of the distances from the foci, which is convex along the segment.
  const auto sum = [&](double part, double slowness) {
    const Vector3d point = from + part * way;
    const double height = std::hypot(point.z(), std::max(std::abs(point.y()) - width, 0.0)) / slowness;
    return std::hypot(point.x() - 1, height) + std::hypot(point.x() + 1, height);
  };
  double least = std::min(sum(0, 1), sum(1, 1));
  /// Sine of the angle to the direction. Below it, what lies between the ends is too far away to count.
  constexpr double parallel = 1e-3;
  /// Bits of the minimum: it decides how many functions there are, for which three digits suffice.
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

/// Returns log_parameter along both directions of a face, the least over all edges of the other bodies.
Eigen::Vector2d least_parameters(const ChargedFace& face, const ChargedBody& body,
                                 const ChargedBodies& bodies) {
  Eigen::Vector2d least = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  for (const ChargedBody& other : bodies.bodies) {
    if (&other == &body)
      continue;
    for (const Segment& edge : edges_of(other)) {
      least[0] =
          std::min(least[0], log_parameter(edge, face, face.axis_u, face.half_u, face.axis_v, face.half_v));
      least[1] =
          std::min(least[1], log_parameter(edge, face, face.axis_v, face.half_v, face.axis_u, face.half_u));
    }
  }
  return least;
}

/// Returns these of all faces, body after body.
std::vector<Eigen::Vector2d> parameters_of_faces(const ChargedBodies& bodies) {
  std::vector<Eigen::Vector2d> parameters;
  for (const ChargedBody& body : bodies.bodies)
    for (const ChargedFace& face : faces_of(body.surface))
      parameters.push_back(least_parameters(face, body, bodies));
  return parameters;
}

FaceFunctions functions_on_face(const Eigen::Vector2d& parameters, double features, int least) {
  return {functions_for(parameters[0], features, least), functions_for(parameters[1], features, least)};
}

}  // namespace

std::vector<FaceFunctions> a_priori_functions(const ChargedBodies& bodies, double features, int least) {
  std::vector<FaceFunctions> functions;
  for (const Eigen::Vector2d& parameters : parameters_of_faces(bodies))
    functions.push_back(functions_on_face(parameters, features, least));
  return functions;
}

std::vector<double> numbers_of_functions(const ChargedBodies& bodies, std::span<const double> features,
                                         int least) {
  const std::vector<Eigen::Vector2d> faces = parameters_of_faces(bodies);
  std::vector<double> numbers;
  for (const double of_face : features) {
    double number = 0;
    for (const Eigen::Vector2d& parameters : faces)
      number += functions_on_face(parameters, of_face, least).count();
    numbers.push_back(number);
  }
  return numbers;
}

std::optional<ChargedBodies> with_triangles(const ChargedBodies& bodies, const std::vector<bool>& chosen) {
  if (std::none_of(chosen.begin(), chosen.end(), [](bool is) { return is; }))
    return std::nullopt;
  ChargedBodies result = bodies;
  for (std::size_t k = 0; k < chosen.size(); ++k)
    if (chosen[k])
      result.bodies[k].surface = triangulated(bodies.bodies[k].surface);
  return result;
}

std::optional<ChargedBodies> with_triangles_by_proximity(const ChargedBodies& bodies) {
  const std::vector<InducedCharge> charges = induced_charges(bodies);
  std::vector<bool> chosen;
  for (std::size_t own = 0; own < charges.size(); ++own) {
    const auto faces = faces_of(bodies.bodies[own].surface);
    chosen.push_back(std::any_of(faces.begin(), faces.end(), [&](const ChargedFace& face) {
      for (std::size_t k = 0; k < charges.size(); ++k)
        if (k != own && charges[k].is_narrow_on(face))
          return true;
      return false;
    }));
  }
  return with_triangles(bodies, chosen);
}

}  // namespace fringe::detail
