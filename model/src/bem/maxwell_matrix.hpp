#pragma once

#include <cstddef>

#include <Eigen/Core>

/// Operations on capacitance matrices that several solvers share.
namespace fringe::detail {

/// Returns the matrix of the other conductors if the last `floating` ones carry no charge, by the Schur
/// complement.
Eigen::MatrixXd without_floating(const Eigen::MatrixXd& matrix, std::size_t floating);

/// Returns the absolute change of every entry from the coarse to the whole space. Relative to the entry, it
/// is at least the geometric mean of the relative changes of its row's and column's diagonal entries: two
/// errors of an entry off the diagonal may cancel by chance.
Eigen::MatrixXd changes(const Eigen::MatrixXd& fine, const Eigen::MatrixXd& coarse);

}  // namespace fringe::detail
