#include "reduced/outside_charges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "geometry/surface_mesh.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// A shell of charges: its distance from the surface, and its largest number of charges.
struct Shell {
  double distance;
  std::size_t most;
};

constexpr std::array<Shell, 4> shells{Shell{0.12, 240}, Shell{0.25, 140}, Shell{0.5, 80}, Shell{1, 50}};

/// Radius of a sphere about the body, and the number of distant charges on it.
constexpr double far_distance = 3;
constexpr int far_charges = 24;

double surface_distance(std::span<const Panel> panels, const Vector3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Panel& panel : panels)
    least = std::min(least, (panel.centre - point).squaredNorm());
  return std::sqrt(least);
}

}  // namespace

std::vector<Vector3d> spread_out(const std::vector<Vector3d>& candidates, double apart, std::size_t most) {
  std::vector<Vector3d> taken;
  if (candidates.empty())
    return taken;
  std::vector<double> nearest(candidates.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (taken.size() < most) {
    taken.push_back(candidates[next]);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      nearest[k] = std::min(nearest[k], (candidates[k] - taken.back()).squaredNorm());
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    if (nearest[next] < apart * apart)
      break;
  }
  return taken;
}

std::vector<OutsideCharge> outside_charges(std::span<const TriangleSurface> surfaces,
                                           std::span<const Panel> panels) {
  /// Least distance from the surface, relative to the shell's. A charge may come nearer to other parts of the
  /// surface than to its own triangle.
  constexpr double least_distance = 0.8;
  std::vector<OutsideCharge> charges;
  for (const Shell& shell : shells) {
    std::vector<Vector3d> candidates;
    for (const Panel& panel : panels) {
      const Vector3d normal =
          (panel.corners[1] - panel.corners[0]).cross(panel.corners[2] - panel.corners[0]).normalized();
      for (const double side : {1.0, -1.0})
        candidates.emplace_back(panel.centre + side * shell.distance * normal);
    }
    std::erase_if(candidates, [&](const Vector3d& point) {
      check_interruption();
      return surface_distance(panels, point) < least_distance * shell.distance;
    });
    std::vector<Vector3d> points = spread_out(candidates, shell.distance, 2 * shell.most);
    for (const auto& surface : surfaces)
      if (is_closed(surface.triangles))
        std::erase_if(points,
                      [&](const Vector3d& point) { return is_in_polyhedron(surface.triangles, point); });
    // The first points are spread out, too.
    points.resize(std::min(points.size(), shell.most));
    for (const Vector3d& point : points)
      charges.push_back({point, shell.distance});
  }
  for (int k = 0; k < far_charges; ++k) {
    // A spiral by the golden angle spreads points evenly.
    const double height = 1 - (2 * k + 1.0) / far_charges,
                 angle = std::numbers::pi * (3 - std::sqrt(5.0)) * k;
    const double radius = std::sqrt(1 - height * height);
    charges.push_back(
        {far_distance * Vector3d(radius * std::cos(angle), radius * std::sin(angle), height), far_distance});
  }
  return charges;
}

}  // namespace fringe::detail
