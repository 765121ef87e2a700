#pragma once

#include <Eigen/Core>

#include "fringe/maxwell_matrix.hpp"
#include "surface/bodies.hpp"

/// Operations on capacitance matrices that several solvers share.
namespace fringe::detail {

/// A capacitance matrix in the whole space of functions, and in the coarse space of about two thirds of them
/// along each direction.
struct NestedMatrix {
  Eigen::MatrixXd fine;
  Eigen::MatrixXd coarse;
};

/// Returns the block of the floating conductors, which are the last ones, with the capacitors between them
/// and the ground. A conductor that is not there, whose row is zero, gets a unit diagonal element.
Eigen::MatrixXd floating_block(const Eigen::MatrixXd& matrix, const ChargedBodies& bodies);

/// Returns the conductors' potentials (rows) for every conductor at unit potential that is not floating:
/// those of floating conductors are such that they carry no charge but that of their capacitors to ground.
/// Rows of conductors without a charge, which are not there, have no effect.
Eigen::MatrixXd potentials(const Eigen::MatrixXd& matrix, const ChargedBodies& bodies);

/// Returns the matrix of the other conductors if the floating ones carry no charge but that of their
/// capacitors to the ground: the Schur complement.
Eigen::MatrixXd without_floating(const Eigen::MatrixXd& matrix, const ChargedBodies& bodies);

/// Returns the charge on each member of the conductors (rows, those of the first conductor first) for every
/// conductor at unit potential that is not floating; floating ones carry no charge. `matrix` is that of all
/// conductors, `body_charges` has a row for every body.
Eigen::MatrixXd member_charges(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& body_charges,
                               const ChargedBodies& bodies);

/// Returns an answer with the names of the conductors, and no matrix.
MaxwellMatrix named_answer(const ChargedBodies& bodies);

/// Returns the energies to which missing energies are compared: the diagonal of the matrix of all conductors,
/// but infinity for those whose charges need not be accurate.
Eigen::VectorXd asked_energies(const Eigen::MatrixXd& matrix, const ChargedBodies& bodies);

/// Returns the absolute change of every entry from the coarse to the whole space. Relative to the entry, it
/// is at least the geometric mean of the relative changes of its row's and column's diagonal entries: two
/// errors of an entry off the diagonal may cancel by chance.
Eigen::MatrixXd changes(const Eigen::MatrixXd& fine, const Eigen::MatrixXd& coarse);

}  // namespace fringe::detail
