#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// A triangle with a unit charge spread evenly.
struct Panel {
  Triangle corners;
  Eigen::Vector3d centre;
  double radius;  ///< of a sphere about the centre that contains the corners
  double area;
};

Panel make_panel(const Triangle& corners);

/// Returns the mean of the corners.
Eigen::Vector3d centre_of(const Triangle& triangle);

/// Returns the normal of a triangle, of length one, to the side from which it is anticlockwise.
Eigen::Vector3d unit_normal(const Triangle& triangle);

/// Returns the middles of the sides, each after the corner it begins at.
std::array<Eigen::Vector3d, 3> middles_of_sides(const Triangle& triangle);

/// Returns the four triangles between the corners and a point of each side, or its middle: those at the
/// corners, then the middle one.
std::array<Triangle, 4> quarters(const Triangle& triangle, const std::array<Eigen::Vector3d, 3>& middles);
std::array<Triangle, 4> quarters(const Triangle& triangle);

/// Adds the centres of the parts that so many quarterings make of a triangle.
void add_centres_of_parts(const Triangle& triangle, int quarterings, std::vector<Eigen::Vector3d>& centres);

/// Halves a triangle from a point of a side, or its middle, to the opposite corner. A side is given by the
/// corner it begins at.
std::array<Triangle, 2> halves(const Triangle& triangle, std::size_t side, const Eigen::Vector3d& middle);
std::array<Triangle, 2> halves(const Triangle& triangle, std::size_t side);

/// Returns the longest side, by the corner it begins at; of several the first.
std::size_t longest_side(const Triangle& triangle);

/// Returns the side across which to halve a triangle: the one along which the densities of the quarters at
/// its ends differ most, or the longest of a slim triangle. `quarter_charges` has a row for each quarter and
/// a column for each right-hand side. On a round surface sides that are far from it count, too: `bends` are
/// the energies that their distances cost per square of the triangle's charge, 1/m.
std::size_t side_to_halve(const Triangle& triangle, const Eigen::MatrixXd& quarter_charges,
                          const std::array<double, 3>& bends = {});

/// Returns the shortest distance from a point to a segment, given by its ends.
double segment_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Returns the shortest distance from a point to a triangle's outline, where the potential of its charge is
/// singular.
double outline_distance(const Triangle& triangle, const Eigen::Vector3d& point);

/// Returns the shortest distance from a point to a triangle.
double triangle_distance(const Triangle& triangle, const Eigen::Vector3d& point);

}  // namespace fringe::detail
