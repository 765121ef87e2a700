#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "reduced/charge_skeleton.hpp"
#include "reduced/panel_clusters.hpp"
#include "reduced/prepared_shape.hpp"
#include "surface/bodies.hpp"
#include "surface/insulators.hpp"

/// What does not change when a body of triangles moves or grows (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// Largest number of panels; with more the preparation takes many seconds.
constexpr std::size_t most_mesh_panels = 2500;

/// The reduced basis of a body of triangles: the charges with which it responds to others, most important
/// first, each given on every panel. They are orthonormal in the energy.
class PreparedMesh {
 public:
  /// Prepares a body of one or more surfaces that touch or overlap. They are about the origin, with a largest
  /// coordinate of about 1. Panels are refined until energies are within `accuracy`.
  PreparedMesh(std::vector<TriangleSurface> surfaces, double accuracy);

  /// Prepares conductors at one potential with dielectric bodies that are fixed to them, or dielectric bodies
  /// alone, likewise. Their charges are those on the outermost panels, polarisation included.
  PreparedMesh(const InsulatedBodies& bodies, double accuracy);

  /// Returns the surfaces of the conductors, then those of the dielectric bodies.
  const std::vector<TriangleSurface>& surfaces() const { return surfaces_; }
  /// Returns the permittivities of the dielectric bodies over the medium's.
  const std::vector<double>& ratios() const { return ratios_; }
  /// Returns true if one of the surfaces is closed.
  bool is_closed() const { return is_closed_; }
  /// Returns a box around all triangles.
  const BoxNumbers& box() const { return box_; }

  /// Returns the panels that carry the functions' charges.
  const PanelClusters& panels() const { return charged_.panels; }
  /// Returns the charges of all functions at all places of the panels.
  const ChargedPanels& charged_panels() const { return charged_; }

  /// Returns the fewest nodes with so many functions whose potentials have an error of at most `error`,
  /// relative to those of charges of unit energy, at points that are at least so far away (in units of the
  /// body); nullptr if all panels are needed. The first call for a distance finds them.
  const ChargeSkeleton* skeleton(double distance, std::ptrdiff_t functions, double error) const;

  /// Returns the centre of the panel at a place.
  Eigen::Vector3d point(std::ptrdiff_t place) const;

  /// Returns the body with as many functions as a level has.
  PreparedLevel level(int index) const;

 private:
  void set_functions(const std::vector<Panel>& panels, const Eigen::MatrixXd& responses);

  std::vector<TriangleSurface> surfaces_;
  std::vector<double> ratios_;
  bool is_closed_;
  BoxNumbers box_;
  ChargedPanels charged_;
  /// Those that were asked for, by the number of functions, the distance and the accuracy.
  mutable std::map<std::tuple<std::ptrdiff_t, double, double>, std::optional<ChargeSkeleton>> skeletons_;
  double root_ = 0;          ///< square root of the capacitance
  Eigen::MatrixXd missing_;  ///< energies that coarser panels miss
  Eigen::MatrixXd facets_;   ///< energies that the facets of round shapes lack
  Eigen::MatrixXd net_;      ///< net charges of the functions (columns) on each surface, if there are several
};

}  // namespace fringe::detail
