#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// An isolated conductor as `formula` represents it (model/CORRECTIONS.md): prepared once, independent of its
/// pose.
namespace fringe::detail {

/// Neighbouring triangles in approximately one plane, and one triangle that replaces them at sufficient
/// distance.
struct Cluster {
  std::vector<std::size_t> members;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;  ///< of a sphere about the centre around the members; infinite: no common plane
  Triangle stand_in;  ///< with the members' centroid, area and mean normal
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area = 0;
};

struct ChargedSurface {
  std::vector<Triangle> triangles;
  std::vector<Eigen::Vector3d> normals;  ///< of length 1; zero where a triangle has no area
  std::vector<double> areas;             ///< m²
  std::vector<Cluster> clusters;         ///< every triangle is in one of them
  bool closed = false;  ///< whether the triangles bound a volume; then only their outer sides count
  double area = 0;      ///< m², each triangle once
  Eigen::Matrix3Xd nodes;
  Eigen::VectorXd charges;     ///< fractions of the equilibrium charge at the nodes; their sum is 1
  double own_capacitance = 0;  ///< C/ε of the isolated conductor, m
  /// Rows: the linear, then the quadratic polynomials at the nodes, orthonormal with `charges` as weights,
  /// times `charges`.
  Eigen::MatrixXd modes;
  Eigen::Index linear_modes = 0;
};

/// Divides each plate into two triangles, as conductors() does.
std::vector<Triangle> plate_triangles(std::span<const Rectangle> plates);

/// Tests whether a triangle has more area than the rounding of its corners gives to a line.
bool has_area(const Triangle& triangle);

/// Prepares a surface. The triangles must be finite and have an area in total; those whose area is rounding
/// only carry no charge if there are others.
ChargedSurface make_charged_surface(std::vector<Triangle> triangles);

}  // namespace fringe::detail
