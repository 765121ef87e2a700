#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "bem/face.hpp"
#include "fringe/triangle.hpp"
#include "reduced/node_kernels.hpp"

/// What of a body does not change when it moves or grows (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// A shape with so many functions along both directions of each face. Arrays end in whole blocks, filled
/// with zeros, and one more.
struct PreparedLevel {
  int functions;
  std::ptrdiff_t count;            ///< of the functions of all faces
  std::ptrdiff_t padded;           ///< whole_blocks(count)
  std::vector<float> inverse;      ///< of the self matrix
  std::vector<float> net;          ///< the functions' net charges: their moments at a potential of one
  std::vector<float> equilibrium;  ///< the charge at a potential, scaled to the energy one
  std::vector<float> potential;    ///< its moments
  double root;                     ///< of the capacitance: the net charge of `equilibrium`
  std::vector<int> highest;        ///< the functions that the smaller space does not have
  std::vector<float> stiffness;    ///< their energy when the others adapt: the inverse of inverse's block
  std::vector<float> missing;      ///< of triangles: the energies that coarser ones lack; else empty
};

class PreparedMesh;

/// A plate or a box whose largest half side is 1, or a body of triangles about as large.
class PreparedShape {
 public:
  /// The faces at the origin, as in ChargedBody.
  PreparedShape(std::vector<ChargedFace> faces, Eigen::Vector3d half_sides);
  /// A body of triangles, as PreparedMesh has them.
  PreparedShape(std::vector<Triangle> triangles, double accuracy);
  ~PreparedShape();

  /// None of a body of triangles.
  const std::vector<ChargedFace>& faces() const { return faces_; }
  /// nullptr for a plate or box.
  const PreparedMesh* mesh() const { return mesh_.get(); }
  const Eigen::Vector3d& half_sides() const { return half_sides_; }

  /// Points along all edges, the corners included, an eighth of an edge from each other; of a body of
  /// triangles points of its surface.
  NodePoints edge_points() const;

  /// The ends of all edges: 4 or 12; none of a body of triangles.
  const std::vector<std::array<Eigen::Vector3d, 2>>& edges() const { return edges_; }

  static constexpr int levels = 4;
  /// Prepared when it is first asked for.
  const PreparedLevel& level(int index);

 private:
  void set_edge_points(std::vector<Eigen::Vector3d> points);

  std::vector<ChargedFace> faces_;
  Eigen::Vector3d half_sides_;
  std::array<std::vector<float>, 3> edge_points_;  ///< in whole blocks, the last one repeated
  std::ptrdiff_t edge_point_count_;
  std::vector<std::array<Eigen::Vector3d, 2>> edges_;
  std::vector<std::unique_ptr<PreparedLevel>> levels_;
  std::unique_ptr<PreparedMesh> mesh_;
};

/// A matrix in single precision, its columns in whole blocks, and one block more.
std::vector<float> stored(const Eigen::MatrixXd& matrix);

/// How many functions along each direction a level has.
int functions_of_level(int level);

}  // namespace fringe::detail
