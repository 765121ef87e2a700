#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "bem/insulated_matrix.hpp"

namespace fringe::detail {

/// Solutions in the whole space and in the coarse one (rows: the unknowns), and what the coarse space misses.
struct InsulatedSolutions {
  Eigen::MatrixXd fine;
  Eigen::MatrixXd coarse;
  Eigen::MatrixXd details;
};

/// Solves for right sides (columns): by factorisation if there are few unknowns, else by generalised minimal
/// residuals. The same bits for any number of threads.
InsulatedSolutions solved(const InsulatedUnknowns& unknowns, const InsulatedMatrix& matrix,
                          const Eigen::MatrixXd& right_sides, std::size_t threads);

}  // namespace fringe::detail
