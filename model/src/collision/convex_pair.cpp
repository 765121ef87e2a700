#include "collision/convex_pair.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "collision/convex_shape_data.hpp"
#include "fringe/error.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Checks both sets before anything is computed from them.
const Vector3d& checked_origin(Vertices a, Vertices b) {
  check_vertices(a, 'A');
  check_vertices(b, 'B');
  return a.front();
}

}  // namespace

void check_vertices(Vertices vertices, char name) {
  if (vertices.empty())
    throw InputError(fmt::format("{} has no vertices", name));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!vertices[i].allFinite())
      throw InputError(fmt::format("vertex {} of {} is not finite", i, name));
}

Vector3d PlacedConvex::farthest_along(const Vector3d& direction) const {
  const Vector3d turned = pose->linear().transpose() * direction;
  Vector3d point;
  const std::uint32_t index = best_kernels<GjkFilter>().support(*shape, turned.data(), point.data());
  return filter_point(index, point.data());
}

Simplex ConvexPair::start() const {
  // The reciprocals of a shorter direction might not be finite.
  constexpr double shortest = 0x1p-900;
  const Vector3d offset = b.offset - a.offset;
  return {{farthest_along(offset.lpNorm<1>() > shortest ? offset : Vector3d(Vector3d::UnitX()))}, 1};
}

ConvexPair convex_pair(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                       const Isometry3d& pose_b) {
  const Vector3d offset = pose_a.translation() - pose_b.translation();
  const auto placed = [](const ConvexShape& shape, const Isometry3d& pose, const Vector3d& at) {
    return PlacedConvex{&shape.data().support, shape.data().vertices, &pose, Vector3d::Zero(), at};
  };
  return {placed(a, pose_a, offset), placed(b, pose_b, Vector3d::Zero()),
          offset.lpNorm<1>() + a.data().support.bounding_radius + b.data().support.bounding_radius};
}

PassingHull::PassingHull(Vertices vertices, const Vector3d& origin) : vertices_(vertices), origin_(origin) {
  constexpr std::size_t block = VertexBlocks::size;
  const std::size_t count = (vertices.size() + block - 1) / block * block;
  double* coordinates = few_coordinates_.data();
  if (count > SupportShape::few_vertices) {
    many_coordinates_.resize(3 * count);
    coordinates = many_coordinates_.data();
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d point = vertices[std::min(i, vertices.size() - 1)] - origin;
    double* const place = coordinates + i / block * 3 * block + i % block;
    place[0] = point.x(), place[block] = point.y(), place[2 * block] = point.z();
  }
  const double largest =
      Eigen::Map<const Eigen::ArrayXd>(coordinates, static_cast<Eigen::Index>(3 * count)).abs().maxCoeff();
  // Any point of the hull: the midpoint of two vertices that are not neighbours in most lists.
  const Vector3d centre = (vertices.front() - origin) / 2 + (vertices[vertices.size() / 2] - origin) / 2;
  std::copy(centre.begin(), centre.end(), shape_.centre);
  constexpr double root_of_3 = 1.7320508075688774;
  shape_.bounding_radius = root_of_3 * (1 + 0x1p-50) * largest;
  shape_.vertices = {coordinates, static_cast<std::uint32_t>(count),
                     static_cast<std::uint32_t>(vertices.size() - 1)};
}

PlacedConvex PassingHull::placed() const {
  static const Isometry3d identity = Isometry3d::Identity();
  return {&shape_, vertices_, &identity, origin_, Vector3d::Zero()};
}

PassingHulls::PassingHulls(Vertices a, Vertices b)
    : a_(a, checked_origin(a, b)),
      b_(b, a.front()), pair_{a_.placed(), b_.placed(), a_.bounding_radius() + b_.bounding_radius()} {}

}  // namespace fringe::detail
