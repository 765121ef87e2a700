#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "fringe/distance_sensor.hpp"
#include "fringe/error.hpp"
#include "sensing/cone_bounds.hpp"
#include "sensing/triangle_tree.hpp"

namespace fringe {
namespace {

using detail::ConeQuery;
using detail::Sighting;

std::optional<VisiblePoint> point_of(const std::optional<Sighting>& sighting) {
  return sighting ? std::optional(sighting->point) : std::nullopt;
}

}  // namespace

ConeMethod parse_cone_method(std::string_view text) {
  if (text == "field_of_view")
    return ConeMethod::field_of_view;
  if (text == "cone_equation")
    return ConeMethod::cone_equation;
  throw InputError(fmt::format("unknown method \"{}\": it is field_of_view or cone_equation", text));
}

void validate(const SensingCone& cone) {
  if (!cone.apex.allFinite())
    throw InputError("the apex must be finite");
  if (!cone.direction.allFinite())
    throw InputError("the direction must be finite");
  if (cone.direction.isZero(0))
    throw InputError("the direction must not be zero");
  if (!(cone.full_angle > 0 && cone.full_angle <= std::numbers::pi))
    throw InputError(fmt::format("the full angle {} must be in (0, pi]", cone.full_angle));
  if (!(cone.range > 0 && std::isfinite(cone.range)))
    throw InputError(fmt::format("the range {} must be greater than 0 and finite", cone.range));
}

std::optional<VisiblePoint> cone_closest(std::span<const Triangle> triangles, const SensingCone& cone,
                                         ConeMethod method) {
  ConeQuery query(cone, method);
  const detail::ConeBounds bounds(cone, Eigen::Isometry3d::Identity());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    if (!a.allFinite() || !b.allFinite() || !c.allFinite())
      throw InputError(fmt::format("triangle {} is not finite", i));
    if (!bounds.misses(triangles[i], query.reach()))
      query.offer(triangles[i], 0, i);
  }
  return point_of(query.best());
}

SensedSurface::SensedSurface(std::span<const Triangle> triangles)
    : tree_(std::make_unique<const detail::TriangleTree>(triangles)) {}
SensedSurface::~SensedSurface() = default;
SensedSurface::SensedSurface(SensedSurface&&) noexcept = default;
SensedSurface& SensedSurface::operator=(SensedSurface&&) noexcept = default;

std::optional<VisiblePoint> SensedSurface::closest(const SensingCone& cone, ConeMethod method,
                                                   const Eigen::Isometry3d& pose) const {
  ConeQuery query(cone, method);
  tree_->search(query, pose, 0);
  return point_of(query.best());
}

}  // namespace fringe
