#include "bem/panel_equations.hpp"

#include "bem/jacobi_basis.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::VectorXd;

PanelUnknowns number_unknowns(const ChargedBodies& bodies, const GalerkinSystem& faces,
                              const PanelMesh& mesh) {
  PanelUnknowns unknowns;
  for (std::size_t face = 0; face < faces.faces(); ++face) {
    unknowns.first.push_back(unknowns.functions);
    const FaceFunctions functions = faces.functions(face);
    for (int k = 0; k < functions.count(); ++k)
      (is_coarse(functions, k) ? unknowns.coarse : unknowns.highest).push_back(unknowns.functions + k);
    unknowns.functions += functions.count();
  }
  unknowns.net = Eigen::MatrixXd::Zero(unknowns.functions + index_of(mesh.panels().size()),
                                       index_of(bodies.conductors.size()));
  for (std::size_t face = 0; face < faces.faces(); ++face)
    unknowns.net(unknowns.first[face], index_of(faces.conductor(face))) = faces.net_charge(face);
  for (const PanelGroup& group : mesh.groups())
    unknowns.net.col(index_of(bodies.bodies[group.body].conductor))
        .segment(unknowns.functions + index_of(group.first), index_of(group.count))
        .setOnes();
  return unknowns;
}

PanelUnknowns without_targets(PanelUnknowns unknowns, const ChargedBodies& bodies,
                              const GalerkinSystem& faces, const PanelMesh& mesh) {
  unknowns.present = VectorXd::Ones(unknowns.net.rows());
  for (std::size_t face = 0; face < faces.faces(); ++face)
    if (faces.is_target(face))
      unknowns.present.segment(unknowns.first[face], faces.functions(face).count()).setZero();
  for (const PanelGroup& group : mesh.groups())
    if (bodies.bodies[group.body].is_target)
      unknowns.present.segment(unknowns.functions + index_of(group.first), index_of(group.count)).setZero();
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
    if (bodies.conductors[k].role == Role::grounded)
      unknowns.net.col(index_of(k)).setZero();
    else
      unknowns.net.col(index_of(k)).array() *= unknowns.present.array();
  }
  return unknowns;
}

}  // namespace fringe::detail
