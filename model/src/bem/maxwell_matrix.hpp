#pragma once

#include <cstddef>

#include <Eigen/Core>

/// What several answers make of the matrices they solve for.
namespace fringe::detail {

/// The matrix of the others when the last `floating` conductors carry no charge.
Eigen::MatrixXd without_floating(const Eigen::MatrixXd& matrix, std::size_t floating);

/// The change of every entry from the smaller space to the larger, but relative to the entry not less than
/// those of its row's and column's own: two errors of an entry off the diagonal may cancel by chance.
Eigen::MatrixXd changes(const Eigen::MatrixXd& fine, const Eigen::MatrixXd& coarse);

}  // namespace fringe::detail
