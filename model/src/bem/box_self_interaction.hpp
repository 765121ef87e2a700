#pragma once

#include <array>

#include <Eigen/Core>

#include "bem/face.hpp"

/// The interaction of a box's faces with each other (model/BOUNDARY_ELEMENTS.md, section 4).
namespace fringe::detail {

constexpr std::size_t box_faces = 6;

/// The faces of a box at the origin, its sides along the axes: −x, +x, −y, +y, −z, +z. Those of x run along y
/// and z, those of y along x and z, those of z along x and y.
std::array<ChargedFace, box_faces> faces_of_box(const Eigen::Vector3d& half_sides);

/// The interaction of two opposite faces of half sides a and b, `distance` apart; rows and columns as in
/// SelfTable::matrix.
Eigen::MatrixXd opposite_faces(FaceFunctions first, FaceFunctions second, double a, double b,
                               double distance);

/// The interaction of two faces at right angles that share an edge of half length `shared`. The first
/// reaches from it by 2·first_width, the second by 2·second_width; rows (s, j): s along the edge, j across;
/// columns (t, l) likewise. Across, x = −1 lies on the edge.
Eigen::MatrixXd adjacent_faces(FaceFunctions first, FaceFunctions second, double shared, double first_width,
                               double second_width);

/// The self matrix of a box, the faces in the order of faces_of_box.
Eigen::MatrixXd box_matrix(const Eigen::Vector3d& half_sides,
                           const std::array<FaceFunctions, box_faces>& functions);

}  // namespace fringe::detail
