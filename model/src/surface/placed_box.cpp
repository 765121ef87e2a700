#include "surface/placed_box.hpp"

#include <algorithm>

namespace fringe::detail {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/// Distance from a body, relative to its size, within which parts are to be equal in size.
constexpr double softness = 0.2;

}  // namespace

AlignedBox3d moved_box(const AlignedBox3d& box, const Isometry3d& pose) {
  AlignedBox3d result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(pose * box.corner(static_cast<AlignedBox3d::CornerType>(corner)));
  return result;
}

PlacedBox placed_box(std::span<const Triangle> triangles) {
  const Triangle& first = triangles.front();
  const Vector3d u = (first[1] - first[0]).stableNormalized(),
                 normal = u.cross(first[2] - first[0]).stableNormalized();
  PlacedBox result{Isometry3d::Identity(), {}};
  if (normal.norm() > 0.5) {
    result.to_box.linear().row(0) = u;
    result.to_box.linear().row(1) = normal.cross(u);
    result.to_box.linear().row(2) = normal;
  }
  for (const Triangle& triangle : triangles)
    for (const Vector3d& corner : triangle)
      result.box.extend(result.to_box * corner);
  return result;
}

std::vector<PlacedBox> boxes_of_used(const ChargedBodies& bodies,
                                     const std::vector<ChargedReading>& readings) {
  std::vector<PlacedBox> boxes;
  for (const ChargedBody& body : bodies.bodies) {
    const auto conductor = static_cast<Index>(body.conductor);
    if (std::none_of(readings.begin(), readings.end(), [&](const ChargedReading& reading) {
          return reading.sense[conductor] != 0 || reading.drive[conductor] != 0;
        }))
      continue;
    boxes.push_back(placed_box(triangulated(body.surface).triangles));
  }
  return boxes;
}

double relative_size(const AlignedBox3d& part, const std::vector<PlacedBox>& used) {
  const double size = part.diagonal().norm();
  double largest = 0;
  for (const PlacedBox& box : used) {
    const AlignedBox3d around = moved_box(box.box, box.to_box.inverse(Eigen::Isometry));
    largest =
        std::max(largest, size / (part.exteriorDistance(around) + softness * box.box.diagonal().norm()));
  }
  return largest;
}

double Approach::relative_size(const AlignedBox3d& part) const {
  const double size = part.diagonal().norm();
  double largest = 0;
  for (const Isometry3d& pose : poses) {
    const Vector3d centre = pose * part.center();
    for (const PlacedBox& box : boxes)
      largest = std::max(largest, size / (std::max(box.distance(centre) - size / 2, 0.0) +
                                          softness * box.box.diagonal().norm()));
  }
  return largest;
}

}  // namespace fringe::detail
