#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "bem/facet_effects.hpp"
#include "bem/insulated_equations.hpp"
#include "bem/panel_mesh.hpp"
#include "bem/undivided_gain.hpp"
#include "readings/maxwell_matrix.hpp"
#include "surface/insulators.hpp"

namespace fringe::detail {

/// The capacitances of a set of bodies, in metres, and what the panels carry for every conductor at unit
/// potential (columns): the charge of a conductor's panel, the potential of an interface's.
struct InsulatedSolution {
  NestedMatrix matrix;  ///< as it is solved: not quite symmetric
  /// The matrix for charges in the whole space and potentials of interfaces in the coarse one.
  Eigen::MatrixXd half_refined;
  Eigen::MatrixXd extrapolated;  ///< beyond the whole space
  Eigen::MatrixXd panels;
  Eigen::MatrixXd details;            ///< what panels carry beyond the coarse space
  Eigen::MatrixXd almost_conductors;  ///< charges beyond it of dielectric bodies that are almost conductors
  InsulatedUnknowns unknowns;
  Eigen::MatrixXd body_charges;      ///< on each body of a conductor, in the whole space
  Eigen::VectorXd error_indicators;  ///< of the groups of panels, relative to each conductor's own entry
  Eigen::MatrixXd undivided;         ///< of undivided triangles, UndividedGain::roots
  Eigen::MatrixXd facets;            ///< errors by those of round shapes, FacetEffects::errors
  Eigen::MatrixXd lasting_facets;    ///< those that no refinement makes less
  Eigen::MatrixXd film_effects;      ///< of the thickness of thin films, each counted as positive
  Eigen::VectorXd missed_energies;   ///< the sums over all groups, for each conductor at unit potential
};

/// Answers of bodies with grounded conductors to potentials of charges elsewhere (columns); zeros where a
/// panel has none.
struct InsulatedResponse {
  Eigen::MatrixXd potentials;         ///< of the interfaces' panels (rows: all panels)
  Eigen::MatrixXd coarse_potentials;  ///< the same in the coarse space
  Eigen::MatrixXd charges;            ///< free charges of the conductors' panels
  Eigen::VectorXd energies;           ///< that groups of panels miss, the largest of all columns
};

/// How much the changes of the readings change from the coarse to the whole space.
struct StepsOfChanges {
  Eigen::VectorXd by_charges;
  Eigen::VectorXd by_potentials;  ///< of interfaces
};

/// Returns the symmetric part of a matrix.
Eigen::MatrixXd symmetric(const Eigen::MatrixXd& matrix);

/// The boundary element equations of conductors and dielectric bodies (model/BOUNDARY_ELEMENTS.md, section
/// 13), with the single layer as a hierarchical matrix.
class InsulatedSystem {
 public:
  /// Divides the surfaces into panels, graded towards the sharp edges. Only parts that exist with all bodies
  /// or with one of the `others` get panels.
  InsulatedSystem(const InsulatedBodies& bodies, const std::vector<Presence>& others,
                  const PanelGrading& grading, std::size_t threads);

  const PanelMesh& mesh() const { return mesh_; }
  std::size_t panels() const { return mesh_.panels().size(); }
  const std::vector<PanelGroup>& groups() const { return mesh_.groups(); }

  /// Returns a relative error that undivided dielectric bodies may have which are almost conductors: their
  /// potential hardly varies, so that it does not show what their charge lacks. It is one over the fewest
  /// triangles of such a body.
  double undivided_error() const;

  /// Evaluates both operators; `tolerance` is the error aimed at for each element. Panels of conductors that
  /// coincide or nearly do get a ridge on the diagonal of the single layer, by which they share their charge.
  void evaluate(double tolerance);

  /// Returns the energy that the ridge takes from each panel, per squared charge.
  const Eigen::VectorXd& ridge_effects() const { return ridge_effects_; }

  /// Solves for all bodies (set 0) or for one of the `others` (1, 2, …).
  InsulatedSolution solve(std::size_t set) const;

  /// Returns the energies that groups of panels miss in the changes of readings, by the solutions with the
  /// targets and without them: the largest of all readings, relative to its change.
  Eigen::VectorXd change_indicators(const InsulatedSolution& all, const InsulatedSolution& background,
                                    const StepsOfChanges& steps) const;

  /// Solves for all bodies in outer potentials, given by their means on the panels (rows). Energies are
  /// relative to `own`, one for each column.
  InsulatedResponse respond(const Eigen::MatrixXd& outer, const Eigen::VectorXd& own) const;

  /// Returns the panels that border on the space outside of all bodies, in their order.
  std::vector<Eigen::Index> outermost_panels() const;

  /// Returns the single-layer matrix of some panels, in their order.
  Eigen::MatrixXd single_layer(const std::vector<Eigen::Index>& panels) const {
    return single_layer_->block(panels);
  }
  /// Returns the largest number of panels whose matrices take no more than some bytes, if as many of them as
  /// now are sources of the double layer.
  std::size_t most_panels(double bytes) const;

  /// Divides the marked groups of panels.
  void refine(const std::vector<int>& marked, const Eigen::MatrixXd& panels);

 private:
  void raise_diagonal(double tolerance);
  /// Tells for every panel, in any of the sets, if the permittivities on both sides of it differ or a thin
  /// film lies on it.
  std::vector<bool> have_flux() const;

  const InsulatedBodies& bodies_;
  std::vector<Surroundings> surroundings_;  ///< of all sets
  std::size_t threads_;
  PanelMesh mesh_;
  std::unique_ptr<PanelOperator> single_layer_;
  DoubleLayer double_layer_;
  Eigen::VectorXd ridge_effects_;
  QuartersWithAngles quarters_;  ///< of undivided triangles
  BesideFacets facets_;
  double tolerance_ = 1;  ///< of the operators
};

}  // namespace fringe::detail
