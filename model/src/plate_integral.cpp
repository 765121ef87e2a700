#include "fringe/plate_integral.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include <fmt/format.h>

#include "clipping.hpp"
#include "fringe/error.hpp"
#include "gauss.hpp"
#include "kernel.hpp"
#include "plate_frame.hpp"
#include "splitting.hpp"

namespace fringe {
namespace {

using namespace detail;
using Eigen::Vector3d;

/// The kernel of a triangle that lies in one cell.
double kernel_in_cell(const PlateFrame& plate, Cell cell, const Vector3d& a, const Vector3d& b,
                      const Vector3d& c) {
  if (cell.u == Strip::within && cell.v == Strip::within)
    return kernel_of_heights(a.z(), b.z(), c.z());
  return kernel(from_plate(plate, cell, a), from_plate(plate, cell, b), from_plate(plate, cell, c));
}

/// The kernel of a piece in one cell, weighted by its share of the whole triangle: the sum over a fan.
double kernel_of_piece(const PlateFrame& plate, Cell cell, const Piece& piece) {
  double sum = 0;
  const PieceVertex& hub = piece.vertices[0];
  for (std::size_t i = 1; i + 1 < piece.size; ++i) {
    const PieceVertex &first = piece.vertices[i], &second = piece.vertices[i + 1];
    const double share = share_of_area(hub, first, second);
    if (share > 0)
      sum += share * kernel_in_cell(plate, cell, hub.position, first.position, second.position);
  }
  return sum;
}

/// The integral in closed form: the triangle is cut at the plate's border planes, and every piece is
/// integrated in its own cell (model/NUMERICS.md).
double exact_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area) {
  const Piece uncut = whole(triangle);
  const Extent extent_u = extent(uncut, 0), extent_v = extent(uncut, 1);
  const std::optional<Strip> only_u = only_strip(extent_u, plate.length_u);
  const std::optional<Strip> only_v = only_strip(extent_v, plate.length_v);
  if (only_u && only_v)
    return twice_area * kernel_in_cell(plate, {*only_u, *only_v}, triangle[0], triangle[1], triangle[2]);
  double sum = 0;
  for (const Strip u : strips) {
    if (!has_share(u, extent_u, plate.length_u))
      continue;
    const Piece in_u = clip_to_strip(uncut, 0, u, plate.length_u);
    const Extent extent_in_u = extent(in_u, 1);
    for (const Strip v : strips)
      if (has_share(v, extent_in_u, plate.length_v))
        sum += kernel_of_piece(plate, {u, v}, clip_to_strip(in_u, 1, v, plate.length_v));
  }
  return twice_area * sum;
}

/// A triangle that has points on both sides of the plate's plane, or on it.
bool meets_plane(const LocalTriangle& triangle) {
  const auto [lowest, highest] = std::minmax({triangle[0].z(), triangle[1].z(), triangle[2].z()});
  return lowest <= 0 && highest >= 0;
}

/// A method with what it prepares once for all triangles.
class Integrator {
 public:
  explicit Integrator(const Method& method) : method_(method) {
    if (const auto* gauss = std::get_if<Gauss>(&method))
      rule_ = gauss_rule(gauss->points);
  }

  double operator()(const PlateFrame& plate, const Triangle& triangle) const {
    const double doubled = twice_area(triangle);
    if (doubled == 0)
      return 0;
    const LocalTriangle local = to_local(plate, triangle);
    if (std::holds_alternative<Exact>(method_))
      return exact_integral(plate, local, doubled);
    // A sum over nodes is finite even where the integral is not, and only a triangle that meets the plate's
    // plane can touch the plate.
    if (meets_plane(local) && std::isinf(exact_integral(plate, local, doubled)))
      return std::numeric_limits<double>::infinity();
    if (const auto* split = std::get_if<Split>(&method_))
      return split_integral(plate, local, doubled, split->levels);
    return gauss_integral(plate, local, doubled, rule_);
  }

 private:
  Method method_;
  GaussRule rule_;
};

void validate(const Method& method) {
  // What the text form refuses is refused here too.
  parse_method(to_string(method));
}

void validate(const Triangle& triangle) {
  for (std::size_t i = 0; i < 3; ++i)
    if (!triangle[i].allFinite())
      throw InputError(fmt::format("vertex {} is not finite", i));
}

}  // namespace

double plate_integral(const Triangle& triangle, const Rectangle& plate, const Method& method) {
  validate(plate);
  validate(method);
  validate(triangle);
  return Integrator(method)(plate_frame(plate), triangle);
}

std::vector<double> plate_integrals(std::span<const Triangle> triangles, const Rectangle& plate,
                                    const Method& method) {
  validate(plate);
  validate(method);
  const PlateFrame frame = plate_frame(plate);
  const Integrator integrate(method);
  std::vector<double> integrals;
  integrals.reserve(triangles.size());
  for (const Triangle& triangle : triangles) {
    try {
      validate(triangle);
    } catch (const InputError& error) {
      throw InputError(fmt::format("triangle {}: {}", integrals.size(), error.what()));
    }
    integrals.push_back(integrate(frame, triangle));
  }
  return integrals;
}

}  // namespace fringe
