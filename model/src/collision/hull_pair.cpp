#include "collision/hull_pair.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::detail {
namespace {

/// Returns the largest coordinate of the vertices relative to the origin, in magnitude.
double extent_from(Vertices vertices, const Eigen::Vector3d& origin) {
  double extent = 0;
  for (const Eigen::Vector3d& vertex : vertices)
    extent = std::max(extent, (vertex - origin).cwiseAbs().maxCoeff());
  return extent;
}

}  // namespace

void check_vertices(Vertices vertices, char name) {
  if (vertices.empty())
    throw InputError(fmt::format("{} has no vertices", name));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!vertices[i].allFinite())
      throw InputError(fmt::format("vertex {} of {} is not finite", i, name));
}

HullPair hull_pair(Vertices a, Vertices b) {
  check_vertices(a, 'A');
  check_vertices(b, 'B');
  const Eigen::Vector3d& origin = a.front();
  return {a, b, origin, extent_from(a, origin) + extent_from(b, origin)};
}

Extreme farthest_along(Vertices vertices, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  Extreme extreme{0, -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double product = (vertices[i] - origin).dot(direction);
    if (product > extreme.product)
      extreme = {i, product};
  }
  return extreme;
}

}  // namespace fringe::detail
