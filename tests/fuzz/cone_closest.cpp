#include <algorithm>
#include <cmath>
#include <vector>

#include "fringe/distance_sensor.hpp"
#include "fringe/error.hpp"
#include "input.hpp"

namespace fringe::fuzz {

void cone_closest(Bytes bytes) {
  constexpr std::size_t most_triangles = 6;
  Input input(bytes);
  SensingCone cone{input.point(), input.point(), 0, 0};
  // Angles from the narrowest to the half space.
  cone.full_angle = std::ldexp(1 + input.byte() % 200, -(input.byte() % 8)) / 64;
  cone.range = std::abs(input.number());
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < most_triangles && !input.empty(); ++i)
    triangles.push_back({input.point(), input.point(), input.point()});
  try {
    const auto seen = fringe::cone_closest(triangles, cone, ConeMethod::field_of_view);
    const auto other = fringe::cone_closest(triangles, cone, ConeMethod::cone_equation);
    if (seen) {
      require(seen->distance >= 0 && seen->point.allFinite(), "what is seen has a place");
      require(seen->triangle < triangles.size(), "what is seen is one of the triangles");
    }
    std::vector<Eigen::Vector3d> points{cone.apex, cone.direction, {cone.range, 0, 0}};
    for (const Triangle& triangle : triangles)
      points.insert(points.end(), triangle.begin(), triangle.end());
    if (!ordinary(points))
      return;
    // Rounding, of the angle by 2^-50, decides what happens at the cone's boundary. A triangle that is seen
    // with certainty is also seen by a slightly wider cone.
    constexpr double rounding = 1e-12;
    SensingCone wider = cone;
    wider.full_angle = std::min(cone.full_angle * (1 + rounding), 3.141592653589793);
    wider.range *= 1 + rounding;
    // In units of the farthest vertex: distances below `lost` may or may not count as the apex, and a
    // distance is rounded by some 2^-100 (NUMERICS, section 14).
    constexpr double lost = 0x1p-88, trace = 0x1p-98;
    double size = 0;
    for (const Eigen::Vector3d& point : points)
      size = std::max(size, point.cwiseAbs().maxCoeff());
    wider.range += trace * size;
    for (const auto& found : {seen, other}) {
      if (!found || found->distance <= lost * size)
        continue;
      require(found->distance <= wider.range, "what is seen is in the range");
      for (const ConeMethod method : {ConeMethod::field_of_view, ConeMethod::cone_equation}) {
        const auto surely = fringe::cone_closest(triangles, wider, method);
        require(surely && surely->distance <= found->distance * (1 + rounding) + trace * size,
                "a wider cone sees no less");
      }
    }
  } catch (const InputError&) {
    // The input is not finite, or is not a cone.
  }
}

}  // namespace fringe::fuzz
