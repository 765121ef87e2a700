#include "fringe/plate_integral.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include <fmt/format.h>

#include "fringe/batch_integral.hpp"
#include "fringe/error.hpp"
#include "geometry/plate_frame.hpp"
#include "integral/derivative/plate_wrench.hpp"
#include "integral/kernel.hpp"
#include "integral/node_sums.hpp"
#include "integral/pieces.hpp"

namespace fringe {
namespace {

using namespace detail;
using Eigen::Vector3d;

/// Computes ∫dA/d over one triangle of any shape in closed form. Cuts the triangle at the plate's border
/// planes and integrates every piece in its own cell (model/NUMERICS.md, sections 2 to 7).
double exact_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area) {
  double sum = 0;
  for_each_piece(plate, triangle,
                 [&](Cell cell, const Vector3d& a, const Vector3d& b, const Vector3d& c, double share) {
                   sum += share * kernel_from_plate(from_plate(plate, cell, a), from_plate(plate, cell, b),
                                                    from_plate(plate, cell, c));
                 });
  return twice_area * sum;
}

/// Returns whether a triangle meets the plate's plane.
bool meets_plane(const LocalTriangle& triangle) {
  const auto [lowest, highest] = std::minmax({triangle[0].z(), triangle[1].z(), triangle[2].z()});
  return lowest <= 0 && highest >= 0;
}

/// Integrates triangles by one method, with the quadrature rule prepared once for all triangles.
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
    // A sum over nodes is finite even where the integral diverges. Only a triangle that meets the plate's
    // plane can touch the plate.
    if (meets_plane(local) && std::isinf(exact_integral(plate, local, doubled)))
      return std::numeric_limits<double>::infinity();
    const auto distance_to_plate = [&](const Vector3d& point) { return distance(plate, point); };
    if (const auto* split = std::get_if<Split>(&method_))
      return split_integral(local, doubled, split->levels, distance_to_plate);
    return gauss_integral(local, doubled, rule_, distance_to_plate);
  }

 private:
  Method method_;
  GaussRule rule_;
};

void validate(const Method& method) {
  // Parsing the text form applies the limits of the parameters.
  if (!is_integral(parse_method(to_string(method))))
    throw InputError(fmt::format(
        "method {} is for whole scenes: triangles alone are integrated by exact, split:N or gauss:K",
        to_string(method)));
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
  if (std::holds_alternative<Exact>(method))
    return plate_integrals(TriangleBatch(triangles), plate);
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

IntegralDerivatives plate_integral_derivatives(const Triangle& triangle, const Rectangle& plate) {
  validate(plate);
  validate(triangle);
  const Wrench wrench = plate_wrench(TriangleBatch(std::span(&triangle, 1)), plate);
  return {wrench.force, wrench.torque};
}

}  // namespace fringe
