#pragma once

#include <array>

#include <Eigen/Core>

#include "bem/face.hpp"

/// The single-layer interaction of a box's faces with each other (model/BOUNDARY_ELEMENTS.md, section 4).
namespace fringe::detail {

constexpr std::size_t box_faces = 6;

/// Returns the faces of a box centred at the origin with its sides along the axes, in the order −x, +x, −y,
/// +y, −z, +z. The directions u and v are y and z on the faces of x, x and z on those of y, x and y on those
/// of z.
std::array<ChargedFace, box_faces> faces_of_box(const Eigen::Vector3d& half_sides);

/// Computes the single-layer block of two faces at right angles that share an edge of half length `shared`.
/// The first face extends from it by 2·first_width, the second by 2·second_width. Rows are (s, j), with s
/// along the edge and j across it; columns are (t, l) likewise. Across the edge, x = −1 lies on it.
Eigen::MatrixXd adjacent_faces(FaceFunctions first, FaceFunctions second, double shared, double first_width,
                               double second_width);

/// Computes the single-layer matrix of a box, with the faces in the order of faces_of_box.
Eigen::MatrixXd box_self_interaction(const Eigen::Vector3d& half_sides,
                                     const std::array<FaceFunctions, box_faces>& functions);

}  // namespace fringe::detail
