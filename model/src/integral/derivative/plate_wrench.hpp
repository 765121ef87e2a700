#pragma once

#include "fringe/rectangle.hpp"
#include "fringe/triangle_batch.hpp"
#include "geometry/wrench.hpp"

/// Derivatives of ∫dA/d with respect to the pose of the triangles (model/NUMERICS.md, section 15).
namespace fringe::detail {

/// Computes the derivatives of Σ∫dA/d over all triangles as they move together and the plate stays; both in
/// the same frame. The relative error of each triangle's share is at most about 1e-8. All numbers are NaN if
/// a triangle touches the plate, to within 2^−44 of the plate's lengths.
Wrench plate_wrench(const TriangleBatch& triangles, const Rectangle& plate);

}  // namespace fringe::detail
