#pragma once

#include <array>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"
#include "surface/face.hpp"

/// The single-layer interaction of a box's faces with each other (model/BOUNDARY_ELEMENTS.md, section 4).
namespace fringe::detail {

/// Computes the single-layer block of two faces at right angles that share an edge of half length `shared`.
/// The first face extends from it by 2·first_width, the second by 2·second_width. Rows are (s, j), with s
/// along the edge and j across it; columns are (t, l) likewise. Across the edge, x = −1 lies on it.
Eigen::MatrixXd adjacent_faces(FaceFunctions first, FaceFunctions second, double shared, double first_width,
                               double second_width);

/// Computes the single-layer matrix of a box, with the faces in the order of faces_of_box.
Eigen::MatrixXd box_self_interaction(const Eigen::Vector3d& half_sides,
                                     const std::array<FaceFunctions, box_faces>& functions);

}  // namespace fringe::detail
