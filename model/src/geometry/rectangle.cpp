#include "fringe/rectangle.hpp"

#include <cmath>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe {

void validate(const Rectangle& rectangle) {
  /// Largest cosine of the angle between the edges: single-precision rotations leave less once cleaned up,
  /// and it is far below what the model's physics resolves.
  constexpr double largest_cosine = 1e-9;
  if (!rectangle.corner.allFinite() || !rectangle.edge_u.allFinite() || !rectangle.edge_v.allFinite())
    throw InputError("the rectangle's corner and edges must be finite");
  const double length_u = rectangle.edge_u.stableNorm(), length_v = rectangle.edge_v.stableNorm();
  if (length_u == 0 || length_v == 0)
    throw InputError("a rectangle's edge must not have length zero");
  if (!std::isfinite(length_u) || !std::isfinite(length_v))
    throw InputError("a rectangle's edge is too long");
  const double cosine = (rectangle.edge_u / length_u).dot(rectangle.edge_v / length_v);
  if (!(std::abs(cosine) <= largest_cosine))
    throw InputError(fmt::format(
        "edge_u and edge_v are not at right angles: the cosine of the angle between them is {:.2g}, "
        "and at most {:g} is taken for rounding",
        cosine, largest_cosine));
}

}  // namespace fringe
