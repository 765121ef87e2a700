#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>

#include "surface/panel.hpp"

/// Thin films as sheets along which the polarisation carries flux (model/BOUNDARY_ELEMENTS.md, section 13).
namespace fringe::detail {

/// A panel of a film that lies on no conductor.
struct SheetPanel {
  Triangle corners;
  double strength;   ///< m, thickness times the relative permittivity less one
  double thickness;  ///< m
};

/// The potential on films, continuous and linear on each panel: the finite elements of the energy of the
/// polarisation along the films. With u the potential and q the bound charges of the panels,
/// u = lifts·U − K⁻¹Bᵀq, U the potentials of the bodies of conductors on which films lie.
class FilmSheets {
 public:
  /// Returns the body of a conductor on which a corner lies.
  using BodyAt = std::function<std::optional<std::size_t>(const Eigen::Vector3d&)>;

  FilmSheets(std::vector<SheetPanel> panels, const BodyAt& body_at, std::size_t bodies);

  /// Returns B K⁻¹ Bᵀ: what the mean potentials of the panels (rows) fall by for unit charges on panels.
  const Eigen::MatrixXd& compliance() const { return compliance_; }

  /// Returns the mean potentials of the panels (rows) for each body at unit potential and no charge.
  const Eigen::MatrixXd& lifts() const { return lifts_; }

  /// Returns the capacitances between bodies through the films alone, over 4πε.
  const Eigen::MatrixXd& direct() const { return direct_; }

  /// Returns the potentials at the corners of the panels, three rows for each, for charges of the panels and
  /// potentials of the bodies (columns).
  Eigen::MatrixXd corner_potentials(const Eigen::MatrixXd& charges, const Eigen::MatrixXd& bodies) const;

  /// Returns the energies of a panel, over 4πε, between all columns of potentials at its three corners.
  Eigen::MatrixXd energy(std::size_t panel, const Eigen::MatrixXd& corners) const;

  /// Returns by how much less a panel beside a conductor carries than it would in a thin film, in the columns
  /// of the potentials at its corners: in films of some thickness, the flux leaves the conductor beside its
  /// border.
  Eigen::MatrixXd crowding(std::size_t panel, const Eigen::MatrixXd& corners) const;

 private:
  std::vector<SheetPanel> panels_;
  std::vector<std::array<Eigen::Index, 3>> nodes_;  ///< of each panel
  std::vector<std::optional<std::size_t>> bodies_;  ///< of each node, the body that it lies on
  Eigen::SparseMatrix<double> nodal_;               ///< nodes by free nodes
  Eigen::MatrixXd body_nodal_;                      ///< nodes by bodies, harmonic
  Eigen::MatrixXd free_response_;                   ///< K⁻¹Bᵀ, free nodes by panels
  Eigen::MatrixXd compliance_, lifts_, direct_;
};

}  // namespace fringe::detail
