#pragma once

#include <array>
#include <span>
#include <vector>

#include "reduced/node_pair.hpp"
#include "reduced/prepared_mesh.hpp"

namespace fringe::detail {

/// Converts between the functions of a body of triangles and charges and potentials at its panels.
class MeshSide {
 public:
  /// Selects a body and its number of functions; `factor` is that between its potentials and those in its own
  /// unit.
  /// Charges are those of all panels or of a skeleton.
  void set(const PreparedMesh& mesh, const ChargedPanels& nodes, std::ptrdiff_t functions, double factor);

  const PreparedMesh& mesh() const { return *mesh_; }
  const PanelClusters& panels() const { return nodes_->panels; }

  /// Computes the charges at all places from the functions' coefficients.
  void spread(const float* coefficients);
  /// Computes the moments of the potentials at all places, in whole blocks.
  void gather(float* moments);

  std::vector<float> charges, potentials;

 private:
  const PreparedMesh* mesh_ = nullptr;
  const ChargedPanels* nodes_ = nullptr;
  std::ptrdiff_t functions_ = 0;
  float factor_ = 1;
  std::vector<float> coefficients_, unused_;
};

/// Points on parts of a body of triangles, with the charges and potentials there.
struct MeshNodes {
  std::vector<MeshPart> parts;
  std::ptrdiff_t count = 0;
  std::array<std::vector<float>, 3> coordinates;
  std::vector<float> charges, potentials;

  NodePoints points() const {
    return {coordinates[0].data(), coordinates[1].data(), coordinates[2].data(), count};
  }

  /// Computes the points of the parts, of a body with axes in its unit about a centre.
  void lay(const PanelClusters& panels, const Eigen::Matrix3f& axes, const Eigen::Vector3f& centre);
  /// Distributes the charges of the panels' places over the points.
  void spread(const MeshSide& body);
  /// Averages the potentials at the points for each place.
  void gather(MeshSide& body) const;
  /// Returns the points with the charges by several columns of coefficients.
  ChargedNodes charged(MeshSide& body, const Eigen::MatrixXf& coefficients);
};

/// The nodes of two bodies of which one or both consist of triangles, with the interface of NodePair.
/// Coordinates and units are those of the first body of triangles.
class MeshPair {
 public:
  /// The bodies are at least `gap` apart, and the smoothness is that on the faces of the body that has some.
  void place(const PlacedBody& a, int functions_a, const PlacedBody& b, int functions_b, double gap,
             const BodySmoothness& of_faces, QuadratureDigits digits);
  void potentials(const float* charges_a, const float* charges_b, float* moments_a, float* moments_b);
  std::vector<Wrench> forces(const Eigen::MatrixXf& charges_a, const Eigen::MatrixXf& charges_b);

  bool is_cut_short() const { return is_cut_short_; }
  double relative_error() const { return relative_error_; }

 private:
  /// Clusters at about the same distance from the other body, and the other body's nodes for them.
  struct Band {
    MeshNodes outer;
    NodeSide faces;  ///< the inner nodes, if the other body has faces
    std::vector<float> matrix;
  };

  void note_parts(const ChargeSkeleton& skeleton);
  void place_skeleton_beside_faces(const PlacedBody& faces, int functions, const BodySmoothness& smooth,
                                   QuadratureDigits digits);
  bool place_skeletons(const PlacedBody& other, int functions, double distance, double error, double part);
  void place_beside_faces(const PlacedBody& faces, int functions, QuadratureDigits digits);
  void place_beside_mesh(const PlacedBody& other, QuadratureDigits digits);
  void lay_inner(const PlacedBody& other);
  Band& next_band();
  void fill(Band& band, const NodePoints& inner);
  int fineness(double panel_radius, double distance, QuadratureDigits digits);

  bool a_is_outer_ = true;
  bool inner_has_faces_ = true;
  Eigen::Isometry3d frame_ = Eigen::Isometry3d::Identity();  ///< of the first body of triangles
  double scale_ = 1;                                         ///< its scale
  MeshSide outer_, inner_;
  std::vector<Band> bands_;
  std::size_t used_ = 0;
  MeshNodes inner_nodes_;
  std::vector<float> moments_;
  double coarsest_ = 0;  ///< largest ratio of a panel part's radius to its distance
  double relative_error_ = 0;
  bool is_cut_short_ = false;
};

}  // namespace fringe::detail
