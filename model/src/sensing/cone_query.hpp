#pragma once

#include <cstddef>
#include <optional>
#include <variant>

#include "fringe/distance_sensor.hpp"
#include "sensing/cone_line.hpp"

namespace fringe::detail {

/// A point that is seen, and on which of several surfaces.
struct Sighting {
  VisiblePoint point;
  std::size_t surface;
};

/// A question that is put to triangles one by one, and its best answer so far. The answer does not depend on
/// the order.
class ConeQuery {
 public:
  /// Throws InputError as validate(cone) does.
  ConeQuery(const SensingCone& cone, ConeMethod method);

  const SensingCone& cone() const { return cone_; }

  /// Points farther than this do not count.
  double reach() const { return reach_; }

  /// Looks at a triangle in the cone's frame of reference. Of equally near ones the one with the lowest
  /// surface and index counts.
  void offer(const Triangle& triangle, std::size_t surface, std::size_t index);

  const std::optional<Sighting>& best() const { return best_; }

 private:
  bool improves(double distance, std::size_t surface, std::size_t index) const;

  SensingCone cone_;
  std::variant<FieldOfView, ConeEquation> method_;
  double reach_;
  std::optional<Sighting> best_;
};

}  // namespace fringe::detail
