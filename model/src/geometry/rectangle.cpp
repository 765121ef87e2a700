#include "fringe/rectangle.hpp"

#include <cmath>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe {
namespace {

using Eigen::Vector3d;

/// A vector as its direction and its length.
struct Polar {
  Vector3d direction;
  double length;
};

/// Returns the sum of the products in the order of the axes; Eigen's order is its own.
double dot(const Vector3d& a, const Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

/// Divides by the largest coordinate first, so that nothing under- or overflows.
Polar polar(const Vector3d& vector) {
  const double largest = vector.cwiseAbs().maxCoeff();
  const Vector3d scaled = vector / largest;
  const double length = std::sqrt(dot(scaled, scaled));
  return {scaled / length, largest * length};
}

}  // namespace

double cosine_between_edges(const Rectangle& rectangle) {
  return dot(polar(rectangle.edge_u).direction, polar(rectangle.edge_v).direction);
}

Rectangle squared(const Rectangle& rectangle) {
  const auto [u, length_u] = polar(rectangle.edge_u);
  const auto [v, length_v] = polar(rectangle.edge_v);
  // The diagonals of a rhombus are at right angles, and halve the angles between its sides.
  const Vector3d along = polar(u + v).direction, across = polar(u - v).direction;
  const double half = std::sqrt(0.5);
  return {rectangle.corner, length_u * (half * (along + across)), length_v * (half * (along - across))};
}

void validate(const Rectangle& rectangle) {
  if (!rectangle.corner.allFinite() || !rectangle.edge_u.allFinite() || !rectangle.edge_v.allFinite())
    throw InputError("the rectangle's corner and edges must be finite");
  const double length_u = rectangle.edge_u.stableNorm(), length_v = rectangle.edge_v.stableNorm();
  if (length_u == 0 || length_v == 0)
    throw InputError("a rectangle's edge must not have length zero");
  if (!std::isfinite(length_u) || !std::isfinite(length_v))
    throw InputError("a rectangle's edge is too long");
  const double cosine = (rectangle.edge_u / length_u).dot(rectangle.edge_v / length_v);
  if (!(std::abs(cosine) <= largest_cosine_of_rounding))
    throw InputError(fmt::format(
        "edge_u and edge_v are not at right angles: the cosine of the angle between them is {:.2g}, "
        "and at most {:g} is taken for rounding",
        cosine, largest_cosine_of_rounding));
}

}  // namespace fringe
