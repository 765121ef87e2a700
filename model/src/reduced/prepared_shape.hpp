#pragma once

#include <array>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"
#include "reduced/node_kernels.hpp"
#include "surface/bodies.hpp"
#include "surface/insulators.hpp"

/// What does not change when a body moves or grows (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// A shape with a number of functions along both directions of each face. Arrays end in whole blocks, filled
/// with zeros, and one block more.
struct PreparedLevel {
  int functions;
  std::ptrdiff_t count;            ///< number of functions of all faces
  std::ptrdiff_t padded;           ///< whole_blocks(count)
  std::vector<float> inverse;      ///< of the single-layer matrix of the body
  std::vector<float> net;          ///< the functions' net charges: their moments at a potential of one
  std::vector<float> equilibrium;  ///< the charge at a constant potential, scaled to unit energy
  std::vector<float> potential;    ///< moments of that charge's potential
  double root;                     ///< square root of the capacitance: the net charge of `equilibrium`
  std::vector<int> highest;        ///< the functions outside the coarse space
  std::vector<float> stiffness;    ///< Schur complement of `highest`: the inverse of that block of `inverse`
  std::vector<float> missing;      ///< for triangles, the energies that coarser ones miss; else empty
  std::vector<float> facets;       ///< the energies that the facets of round shapes lack; empty without any
  /// The functions' net charges on each surface, if the body has several.
  std::vector<std::vector<float>> surface_nets;
};

/// A body with functions on faces.
using FacedSurface = std::variant<FlatPlate, BoxSurface>;

class PreparedMesh;

/// A plate or a box whose largest half side is 1, or a body of triangles about as large.
class PreparedShape {
 public:
  /// Prepares a plate or box at the origin.
  explicit PreparedShape(const FacedSurface& surface);
  /// Prepares a body of triangles, as PreparedMesh does.
  PreparedShape(std::vector<TriangleSurface> surfaces, double accuracy);
  /// Prepares a body with insulators, as PreparedMesh does.
  PreparedShape(const InsulatedBodies& bodies, double accuracy);
  ~PreparedShape();

  /// Returns the faces; none for a body of triangles.
  const std::vector<ChargedFace>& faces() const { return faces_; }
  bool is_plate() const { return std::holds_alternative<FlatPlate>(surface_); }
  bool is_box() const { return std::holds_alternative<BoxSurface>(surface_); }
  /// Returns true if this is the same plate or box.
  bool has_faces_of(const FacedSurface& surface) const;
  /// Returns the mesh of a body of triangles; nullptr for a plate or box.
  const PreparedMesh* mesh() const { return mesh_.get(); }
  const Eigen::Vector3d& half_sides() const { return half_sides_; }

  /// Returns points along all edges, the corners included, an eighth of an edge apart; for a body of
  /// triangles points of its surface.
  NodePoints edge_points() const;

  /// Returns the ends of all edges: 4 or 12; none for a body of triangles.
  const std::vector<std::array<Eigen::Vector3d, 2>>& edges() const { return edges_; }

  static constexpr int levels = 4;
  /// Returns a level, which the first call prepares.
  const PreparedLevel& level(int index);

 private:
  explicit PreparedShape(std::unique_ptr<PreparedMesh> mesh);
  void set_edge_points(std::vector<Eigen::Vector3d> points);

  BodySurface surface_;  ///< without triangles, which mesh_ has
  std::vector<ChargedFace> faces_;
  Eigen::Vector3d half_sides_;
  std::array<std::vector<float>, 3> edge_points_;  ///< in whole blocks, the last point repeated
  std::ptrdiff_t edge_point_count_;
  std::vector<std::array<Eigen::Vector3d, 2>> edges_;
  std::vector<std::optional<PreparedLevel>> levels_;
  std::unique_ptr<PreparedMesh> mesh_;
};

/// Converts a matrix to single precision, with columns in whole blocks, and one block more.
std::vector<float> stored(const Eigen::MatrixXd& matrix);

/// Returns the number of functions of a level along each direction.
int functions_of_level(int level);

}  // namespace fringe::detail
