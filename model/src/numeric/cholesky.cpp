#include "numeric/cholesky.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>

#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;

/// Returns the number of columns that are factorised together, as Eigen chooses it.
Index columns_of_block(Index size) {
  /// Matrices below this size are not divided.
  constexpr Index undivided = 32;
  if (size < undivided)
    return size;
  constexpr Index multiple = 16, least = 8, most = 128;
  return std::clamp(size / 8 / multiple * multiple, least, most);
}

}  // namespace

Cholesky::Cholesky(Eigen::MatrixXd matrix) : factor_(std::move(matrix)) {
  const Index size = factor_.rows(), columns = columns_of_block(size);
  for (Index first = 0; first < size; first += columns) {
    check_interruption();
    const Index count = std::min(columns, size - first), rest = size - first - count;
    auto diagonal = factor_.block(first, first, count, count);
    auto below = factor_.block(first + count, first, rest, count);
    if (Eigen::internal::llt_inplace<double, Eigen::Lower>::unblocked(diagonal) >= 0)
      return;
    if (rest == 0)
      break;
    diagonal.adjoint().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
    factor_.bottomRightCorner(rest, rest).selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
  }
  is_positive_definite_ = true;
}

Eigen::MatrixXd Cholesky::solve_lower(Eigen::MatrixXd right_side) const {
  /// Number of columns that are solved for together.
  constexpr Index columns = 64;
  for (Index first = 0; first < right_side.cols(); first += columns) {
    check_interruption();
    auto here = right_side.middleCols(first, std::min(columns, right_side.cols() - first));
    lower().solveInPlace(here);
  }
  return right_side;
}

}  // namespace fringe::detail
