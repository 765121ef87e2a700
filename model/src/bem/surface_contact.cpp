#include "bem/surface_contact.hpp"

#include <Eigen/Geometry>

#include "fringe/gjk.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

std::vector<AlignedBox3d> boxes_of(std::span<const ConvexHull> hulls, AlignedBox3d& all) {
  std::vector<AlignedBox3d> boxes;
  for (const ConvexHull& hull : hulls) {
    AlignedBox3d& box = boxes.emplace_back();
    for (const Vector3d& vertex : hull)
      box.extend(vertex);
    all.extend(box);
  }
  return boxes;
}

}  // namespace

bool hulls_meet(std::span<const ConvexHull> a, std::span<const ConvexHull> b) {
  AlignedBox3d all_a, all_b;
  const std::vector<AlignedBox3d> boxes_a = boxes_of(a, all_a), boxes_b = boxes_of(b, all_b);
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!boxes_a[k].intersects(all_b))
      continue;
    for (std::size_t l = 0; l < b.size(); ++l)
      if (boxes_a[k].intersects(boxes_b[l]) && gjk_intersects(a[k], b[l]).intersects)
        return true;
  }
  return false;
}

}  // namespace fringe::detail
