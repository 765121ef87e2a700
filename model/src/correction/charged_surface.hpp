#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// A conductor by itself as `formula` knows it (model/CORRECTIONS.md): prepared once, whatever its pose.
namespace fringe::detail {

/// Neighbouring triangles of about one plane, and one triangle in their place for what is far enough away.
struct Cluster {
  std::vector<std::size_t> members;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius =
      0;  ///< of a sphere about the centre that holds the members; infinite: they have no common plane
  Triangle stand_in;  ///< with the members' centroid, area and mean normal
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area = 0;
};

struct ChargedSurface {
  std::vector<Triangle> triangles;
  std::vector<Eigen::Vector3d> normals;  ///< of length 1; zero where a triangle has no area
  std::vector<double> areas;             ///< m²
  std::vector<Cluster> clusters;         ///< of all triangles
  bool closed = false;                   ///< the triangles bound a volume: only their outer side counts
  double area = 0;                       ///< m², each triangle once
  Eigen::Matrix3Xd nodes;
  Eigen::VectorXd charges;     ///< shares of the equilibrium charge at the nodes; their sum is 1
  double own_capacitance = 0;  ///< m: C/ε of the conductor alone
  /// Rows: the linear, then the quadratic polynomials, orthonormal under `charges`, times `charges`.
  Eigen::MatrixXd modes;
  Eigen::Index linear_modes = 0;
};

/// Two triangles for each plate, as in conductors().
std::vector<Triangle> plate_triangles(std::span<const Rectangle> plates);

/// Whether a triangle has more area than rounding its corners makes of a line.
bool has_area(const Triangle& triangle);

/// The triangles must be finite and have an area; those that only rounding gives one carry no charge beside
/// others.
ChargedSurface make_charged_surface(std::vector<Triangle> triangles);

}  // namespace fringe::detail
