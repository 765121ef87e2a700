#include "bem/contact.hpp"

#include <span>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "geometry/winding_number.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// The vertices of a convex part of a body.
using ConvexHull = std::vector<Vector3d>;

/// Returns the convex parts of a body: the hull of all faces, or the triangles.
std::vector<ConvexHull> hulls_of(const BodySurface& surface) {
  std::vector<ConvexHull> hulls;
  if (const auto faces = faces_of(surface); !faces.empty()) {
    ConvexHull& hull = hulls.emplace_back();
    for (const ChargedFace& face : faces)
      for (const Vector3d& corner : corners_of(face))
        hull.push_back(corner);
  }
  for (const Triangle& triangle : triangles_of(surface))
    hulls.emplace_back(triangle.begin(), triangle.end());
  return hulls;
}

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

/// Returns true if any part of one body has a point in common with any part of the other; the test is exact.
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

}  // namespace

void refuse_contact(const ChargedBody& a, const ChargedBody& b) {
  const std::vector<ConvexHull> hulls_a = hulls_of(a.surface), hulls_b = hulls_of(b.surface);
  if (hulls_meet(hulls_a, hulls_b))
    throw InputError(
        fmt::format("{} and {} touch or cross: boundary elements need conductors apart", a.name, b.name));
  for (const auto& [outside, inside, points] : {std::tuple(&a, &b, &hulls_b), std::tuple(&b, &a, &hulls_a)})
    if (const auto surface = triangles_of(outside->surface);
        is_closed(surface) && surrounds(surface, points->front().front()))
      throw InputError(fmt::format("{} is inside {}: boundary elements need conductors apart", inside->name,
                                   outside->name));
}

}  // namespace fringe::detail
