#pragma once

#include <cstddef>
#include <optional>
#include <variant>

#include <Eigen/Core>

#include "fringe/distance_sensor.hpp"
#include "fringe/triangle.hpp"
#include "sensing/precise_cone.hpp"

namespace fringe::detail {

struct NearestPoint {
  double distance;
  Eigen::Vector3d point;
};

/// Finds the point of a finite triangle nearest to the apex among those in a cone of unlimited range. Returns
/// nothing if the triangle is outside the cone.
template <class Method>
std::optional<NearestPoint> nearest_on_triangle(const Triangle& triangle, const Eigen::Vector3d& apex,
                                                const Method& cone);

extern template std::optional<NearestPoint> nearest_on_triangle(const Triangle&, const Eigen::Vector3d&,
                                                                const FieldOfView&);
extern template std::optional<NearestPoint> nearest_on_triangle(const Triangle&, const Eigen::Vector3d&,
                                                                const ConeEquation&);

/// A visible point and the index of its surface.
struct Sighting {
  VisiblePoint point;
  std::size_t surface;
};

/// A query to which triangles are offered one by one; it keeps the best answer so far. The answer does not
/// depend on the order.
class ConeQuery {
 public:
  /// Prepares the cone. Throws InputError as validate(cone) does.
  ConeQuery(const SensingCone& cone, ConeMethod method);

  const SensingCone& cone() const { return cone_; }

  /// Points farther away than this do not count.
  double reach() const { return reach_; }

  /// Updates the answer by a triangle given in the cone's frame of reference. Among equally near triangles
  /// the one with the lowest surface and index counts.
  void offer(const Triangle& triangle, std::size_t surface, std::size_t index);

  const std::optional<Sighting>& best() const { return best_; }

 private:
  /// Tests whether a point is better than the best so far.
  bool improves(double distance, std::size_t surface, std::size_t index) const;

  SensingCone cone_;
  std::variant<FieldOfView, ConeEquation> method_;
  double reach_;
  std::optional<Sighting> best_;
};

}  // namespace fringe::detail
