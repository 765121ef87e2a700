#pragma once

#include <array>

#include "formula/charged_surface.hpp"
#include "fringe/rectangle.hpp"

/// The flux between surfaces that face each other, with arcs as field lines (model/CORRECTIONS.md, section
/// 4).
namespace fringe::detail {

/// Sums over triangles. θ is the angle between a triangle and the plate; all sums are symmetric in the two.
struct FacingFlux {
  double flux = 0;           ///< ∫dA/L, where L is the length of the arc; m
  double soft_flux = 0;      ///< the same with gaps √(g² + s²) instead of g; m
  double tilted_excess = 0;  ///< flux − soft_flux of each triangle, times 1 − cos θ; m
  double area = 0;           ///< area over which they face each other, m²
};

/// A sensor's plate, prepared for many triangles.
struct FacingPlate {
  explicit FacingPlate(const Rectangle& plate);

  std::array<Eigen::Vector3d, 4> corners;  ///< in order around the plate
  Eigen::Vector3d normal;                  ///< of length 1
};

/// Adds the flux between one triangle and the plate.
///
/// @param triangle in the frame of `plate`, with its unit normal and its area
/// @param one_sided whether only the side counts to which the normal points
/// @param softness s, in m
void add_facing_flux(FacingFlux& sum, const Triangle& triangle, const Eigen::Vector3d& normal, double area,
                     bool one_sided, const FacingPlate& plate, double softness);

}  // namespace fringe::detail
