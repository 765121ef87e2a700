#include "collision/convex_pair.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "collision/convex_shape_data.hpp"
#include "fringe/error.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Returns the origin that both hulls of a query are taken relative to.
const Vector3d& origin_of(Vertices a) {
  if (a.empty())
    check_vertices(a, 'A');
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

PassingHull::PassingHull(Vertices vertices, const Vector3d& origin, char name)
    : vertices_(vertices), origin_(origin) {
  if (vertices.empty())
    check_vertices(vertices, name);
  constexpr std::size_t block = VertexBlocks::size;
  const std::size_t count = (vertices.size() + block - 1) / block * block;
  double* coordinates = few_coordinates_.data();
  if (count > SupportShape::few_vertices) {
    many_coordinates_.reset(new double[3 * count]);
    coordinates = many_coordinates_.get();
  }
  const double largest = best_kernels<GjkFilter>().arrange(vertices.data()->data(), vertices.size(),
                                                           origin.data(), coordinates, shape_.centre);
  // Also infinite if differences of finite vertices are.
  if (!std::isfinite(largest))
    check_vertices(vertices, name);
  constexpr double root_of_3 = 1.7320508075688774;
  shape_.bounding_radius = root_of_3 * (1 + 0x1p-50) * largest;
  shape_.vertices = {coordinates, static_cast<std::uint32_t>(count),
                     static_cast<std::uint32_t>(vertices.size() - 1)};
}

PlacedConvex PassingHull::placed() const {
  static const Isometry3d identity = Isometry3d::Identity();
  return {&shape_, vertices_, &identity, origin_, Vector3d::Zero()};
}

PassingHulls::PassingHulls(Vertices a, Vertices b) : a_(a, origin_of(a), 'A'), b_(b, a.front(), 'B') {}

}  // namespace fringe::detail
