#pragma once

#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// A triangle that carries a charge of one, spread evenly.
struct Panel {
  Triangle corners;
  Eigen::Vector3d centre;
  double radius;  ///< of a sphere about the centre that holds the corners
  double area;
};

Panel make_panel(const Triangle& corners);

/// The four triangles between the corners and the middles of the sides: those at the corners, the middle one.
std::array<Triangle, 4> quarters(const Triangle& triangle);

/// The halves of a triangle cut from the middle of the side that begins at a corner to the corner opposite.
std::array<Triangle, 2> halves(const Triangle& triangle, std::size_t side);

/// The side, by the corner it begins at, that is the longest; of several the first.
std::size_t longest_side(const Triangle& triangle);

/// The side of a triangle across which to halve it: along which the densities of its quarters at the corners
/// differ most, by their charges (rows) for any number of cases (columns).
std::size_t side_to_halve(const Triangle& triangle, const Eigen::MatrixXd& quarter_charges);

/// The shortest distance from a point to a segment, given by its ends.
double segment_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// The shortest distance from a point to a triangle's outline, where the potential of its charge is singular.
double outline_distance(const Triangle& triangle, const Eigen::Vector3d& point);

}  // namespace fringe::detail
