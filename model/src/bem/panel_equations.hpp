#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/galerkin_system.hpp"
#include "bem/panel_mesh.hpp"
#include "bem/panel_operator.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// The unknowns of faces and panels: the functions of all faces, one face after the other, then the panels.
struct PanelUnknowns {
  std::vector<Eigen::Index> first;  ///< for each face
  Eigen::Index functions = 0;
  std::vector<Eigen::Index> coarse;   ///< functions of the faces in the coarse space
  std::vector<Eigen::Index> highest;  ///< the faces' other functions
  Eigen::MatrixXd net;                ///< net charges, one column for every conductor
  /// Zero for the unknowns of targets in the equations without these, else one; empty: ones.
  Eigen::VectorXd present;

  bool is_present(Eigen::Index unknown) const { return present.size() == 0 || present[unknown] != 0; }
};

PanelUnknowns number_unknowns(const ChargedBodies& bodies, const GalerkinSystem& faces,
                              const PanelMesh& mesh);

/// Returns the unknowns with those of the targets left out, and net charges of the conductors that readings
/// need: sensors, electrodes and floating ones.
PanelUnknowns without_targets(PanelUnknowns unknowns, const ChargedBodies& bodies,
                              const GalerkinSystem& faces, const PanelMesh& mesh);

/// The matrix of all unknowns, in the blocks in which it is stored.
struct PanelEquations {
  const GalerkinSystem& face_system;
  const PanelMesh& mesh;
  const PanelUnknowns& unknowns;
  const Eigen::MatrixXd& faces;     ///< single-layer matrix of the faces' functions
  const PanelOperator& panels;      ///< single-layer matrix of the panels
  const Eigen::MatrixXf& coupling;  ///< single-layer blocks of the faces' functions (rows) with the panels
  std::size_t threads;              ///< how many compute with them; 0: all
};

}  // namespace fringe::detail
