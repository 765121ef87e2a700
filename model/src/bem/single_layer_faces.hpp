#pragma once

#include <span>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"
#include "surface/face.hpp"

namespace fringe::detail {

/// Computes the single-layer block ∫∫∫∫ f_i(x)f_j(y)·f_k(x')f_l(y')/r of two faces that do not touch, with
/// rows (i, j) of the first and columns (k, l) of the second, j and l running fastest. `tolerance` is the
/// error aimed at, relative to the largest elements (model/BOUNDARY_ELEMENTS.md, section 5).
Eigen::MatrixXd single_layer_block(const ChargedFace& first, FaceFunctions first_functions,
                                   const ChargedFace& second, FaceFunctions second_functions,
                                   double tolerance);

/// Computes the potentials of a face's functions at points, one column for each point.
Eigen::MatrixXd face_potentials(const ChargedFace& face, FaceFunctions functions,
                                std::span<const Eigen::Vector3d> points, double tolerance);

}  // namespace fringe::detail
