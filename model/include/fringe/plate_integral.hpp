#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/method.hpp"
#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

namespace fringe {

/// Computes ∫dA/d over a triangle in metres, where d is the shortest distance from a point of the triangle to
/// the plate (thesis 5.3.1 to 5.3.3). Times the permittivity it is the triangle's share of the capacitance.
///
/// Both sides of the plate count alike. The result is 0 for a triangle without area, and +infinity where the
/// triangle meets the plate in such a way that the integral diverges (it crosses the plate, or an edge lies
/// on it; a single vertex on the plate leaves the integral finite).
///
/// @throws InputError when a vertex is not finite, the plate is not a rectangle, or the method is out of
/// range or one for whole scenes.
double plate_integral(const Triangle& triangle, const Rectangle& plate, const Method& method = Exact{});

/// Computes plate_integral of each triangle, in their order; an error names the triangle by its index.
std::vector<double> plate_integrals(std::span<const Triangle> triangles, const Rectangle& plate,
                                    const Method& method = Exact{});

/// The derivatives of ∫dA/d as the triangle moves rigidly and the plate stays.
struct IntegralDerivatives {
  Eigen::Vector3d translation;  ///< m/m, along the axes
  Eigen::Vector3d rotation;     ///< m/rad, about the axes through the origin
};

/// Computes the derivatives of plate_integral(triangle, plate), in closed form or by a quadrature rule that
/// keeps their errors, relative to ∫dA/d², below about 1e-8. For a plate that moves and a triangle that stays
/// they have the opposite sign. All are NaN where the triangle touches the plate, to within 2^−44 of the
/// plate's lengths: they grow without bound there, even where the integral is finite.
///
/// @throws InputError when a vertex is not finite or the plate is not a rectangle.
IntegralDerivatives plate_integral_derivatives(const Triangle& triangle, const Rectangle& plate);

}  // namespace fringe
