#include "accurate_integral.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <boost/math/quadrature/gauss.hpp>

namespace fringe::benchmarks {
namespace {

using Vector = Eigen::Matrix<long double, 3, 1>;
using Part = std::array<Vector, 3>;

/// The plate 0 ≤ x ≤ side(0), 0 ≤ y ≤ side(1), z = 0.
using Sides = std::array<long double, 2>;

long double distance(const Vector& point, const Sides& sides) {
  const Vector nearest(std::clamp(point.x(), 0.0L, sides[0]), std::clamp(point.y(), 0.0L, sides[1]), 0);
  return (point - nearest).norm();
}

/// Divides a triangle by the plane where a coordinate has the value `level`.
std::vector<Part> cut(const Part& part, Eigen::Index coordinate, long double level) {
  const auto height = [&](const Vector& vertex) { return vertex[coordinate] - level; };
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector &alone = part[i], &next = part[(i + 1) % 3], &last = part[(i + 2) % 3];
    const long double here = height(alone), towards_next = height(next), towards_last = height(last);
    // The plane divides the triangle if one vertex is strictly on its own side, and of the other two none is
    // on that side and not both are in the plane.
    if (here * towards_next > 0 || here * towards_last > 0 || here == 0 ||
        (towards_next == 0 && towards_last == 0))
      continue;
    const Vector to_next = alone + here / (here - towards_next) * (next - alone);
    const Vector to_last = alone + here / (here - towards_last) * (last - alone);
    return {{alone, to_next, to_last}, {to_next, next, last}, {to_next, last, to_last}};
  }
  return {part};
}

long double longest_edge(const Part& part) {
  return std::max({(part[1] - part[0]).norm(), (part[2] - part[1]).norm(), (part[0] - part[2]).norm()});
}

/// Integrates by a product Gauss rule collapsed onto the first vertex (Duffy). On a part no larger than half
/// its distance from the plate the integrand is analytic along every line for a length of the part around it;
/// 15 points then leave an error of about (2 + √5)^-30 < 1e-18.
long double quadrature(const Part& part, const Sides& sides) {
  using Rule = boost::math::quadrature::gauss<long double, 15>;
  const long double twice_area = (part[1] - part[0]).cross(part[2] - part[0]).norm();
  const auto along = [&](long double u) {
    const Vector start = part[0] + u * (part[1] - part[0]), across = u * (part[2] - part[1]);
    const auto inverse_distance = [&](long double v) { return 1 / distance(start + v * across, sides); };
    return u * Rule::integrate(inverse_distance, 0.0L, 1.0L);
  };
  return twice_area * Rule::integrate(along, 0.0L, 1.0L);
}

/// Integrates over a part; bisects it at its longest edge until it is small relative to its distance.
long double integral_of_part(const Part& part, const Sides& sides) {
  const long double longest = longest_edge(part);
  if (longest == 0)
    return 0;
  const Vector centroid = (part[0] + part[1] + part[2]) / 3;
  if (2 * longest <= distance(centroid, sides))
    return quadrature(part, sides);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector &start = part[i], &end = part[(i + 1) % 3], &opposite = part[(i + 2) % 3];
    if ((end - start).norm() == longest) {
      const Vector middle = (start + end) / 2;
      return integral_of_part({start, middle, opposite}, sides) +
             integral_of_part({middle, end, opposite}, sides);
    }
  }
  return 0;
}

}  // namespace

long double accurate_integral(const Triangle& triangle, const Rectangle& plate) {
  const Sides sides{plate.edge_u.x(), plate.edge_v.y()};
  std::vector<Part> parts{
      {triangle[0].cast<long double>(), triangle[1].cast<long double>(), triangle[2].cast<long double>()}};
  for (const Eigen::Index coordinate : {0, 1})
    for (const long double level : {0.0L, sides[static_cast<std::size_t>(coordinate)]}) {
      std::vector<Part> finer;
      for (const Part& part : parts)
        for (const Part& piece : cut(part, coordinate, level))
          finer.push_back(piece);
      parts = finer;
    }
  long double sum = 0;
  for (const Part& part : parts)
    sum += integral_of_part(part, sides);
  return sum;
}

}  // namespace fringe::benchmarks
