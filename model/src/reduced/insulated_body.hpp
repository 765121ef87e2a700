#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"
#include "surface/insulators.hpp"

/// Conductors at one potential and the dielectric bodies that are fixed to them, alone in space
/// (model/BOUNDARY_ELEMENTS.md, section 8).
namespace fringe::detail {

/// How a body answers to potentials of charges elsewhere. Outside of the body its field is that of charges on
/// the outermost panels, polarisation included: these charges bring the potentials there to those that the
/// conductors and interfaces then have. Columns: a constant potential, then the other ones.
struct InsulatedBody {
  std::vector<Panel> panels;        ///< the outermost ones
  Eigen::MatrixXd responses;        ///< charges on them
  Eigen::MatrixXd energies;         ///< of each potential with the responses to each: symmetric
  Eigen::MatrixXd coarse_energies;  ///< the same with one density and one potential on each group
  Eigen::MatrixXd facet_effects;    ///< what the facets of round shapes may add to the energies
  Eigen::MatrixXd free_charges;     ///< on each body of a conductor (rows)
};

/// Returns potentials (columns) of charges elsewhere, as means over panels (rows).
using OuterPotentials = std::function<Eigen::MatrixXd(const std::vector<Panel>&)>;

/// Refines the panels until the energies of the charges that potentials of degree 0 and 1 induce have an
/// error below `accuracy`, as far as `most_panels` panels allow. Conductors have one potential; without any
/// the response to a constant one is zero.
/// @throws InputError if the equations of its outermost panels cannot be solved.
InsulatedBody solve_insulated_body(const InsulatedBodies& bodies, double accuracy, std::size_t most_panels,
                                   const OuterPotentials& potentials);

}  // namespace fringe::detail
