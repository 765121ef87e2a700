#include "sensing/cone_query.hpp"

#include <tuple>

#include "sensing/nearest_on_triangle.hpp"

namespace fringe::detail {
namespace {

using AnyMethod = std::variant<FieldOfView, ConeEquation>;

AnyMethod prepared(const SensingCone& cone, ConeMethod method) {
  validate(cone);
  const PreciseCone precise = precise_cone(cone.direction, cone.full_angle);
  if (method == ConeMethod::field_of_view)
    return FieldOfView(precise);
  return ConeEquation(precise);
}

}  // namespace

ConeQuery::ConeQuery(const SensingCone& cone, ConeMethod method)
    : cone_(cone), method_(prepared(cone, method)), reach_(cone.range * (1 + boundary_width)) {}

void ConeQuery::offer(const Triangle& triangle, std::size_t surface, std::size_t index) {
  const std::optional<NearestPoint> nearest = std::visit(
      [&](const auto& method) { return nearest_on_triangle(triangle, cone_.apex, method); }, method_);
  if (!nearest || !improves(nearest->distance, surface, index))
    return;
  best_ = {{nearest->distance, nearest->point, index}, surface};
  reach_ = nearest->distance;
}

bool ConeQuery::improves(double distance, std::size_t surface, std::size_t index) const {
  if (!best_)
    return distance <= reach_;
  return std::tie(distance, surface, index) <
         std::tie(best_->point.distance, best_->surface, best_->point.triangle);
}

}  // namespace fringe::detail
