#include "numeric/cholesky.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>

#include "numeric/interruption.hpp"
#include "numeric/parallel.hpp"
#include "numeric/products.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Number of columns of the blocks on the diagonal that are factorised and solved by themselves: all else are
/// products.
constexpr Index undivided = 32;

/// Calls task(first, count) for consecutive parts of some columns, on several threads if there are enough
/// operations.
template <class Task>
void for_columns(Index columns, Index together, double operations, std::size_t threads, const Task& task) {
  /// Number of operations that take longer than a thread needs to begin.
  constexpr double enough = 2e6;
  parallel_for(static_cast<std::size_t>((columns + together - 1) / together),
               operations < enough ? 1 : threads, [&](std::size_t part) {
                 const Index first = static_cast<Index>(part) * together;
                 task(first, std::min(together, columns - first));
               });
}

/// Calls task(columns) for parts of the right sides, on several threads.
template <class Task>
void for_right_sides(MatrixXd& right_sides, std::size_t threads, const Task& task) {
  /// Number of columns that are solved for together: at least as many as products take at once, and more
  /// where there are enough for several threads.
  constexpr Index least = 6, most = 24, parts = 4;
  const Index together = std::clamp((right_sides.cols() + parts - 1) / parts, least, most);
  const auto rows = static_cast<double>(right_sides.rows());
  for_columns(right_sides.cols(), together, rows * rows * static_cast<double>(right_sides.cols()), threads,
              [&](Index first, Index count) { task(right_sides.middleCols(first, count)); });
}

}  // namespace

Cholesky::Cholesky(MatrixXd matrix, std::size_t threads) : factor_(std::move(matrix)), threads_(threads) {
  is_positive_definite_ = factorise(0, factor_.rows());
}

/// Factorises some columns, all rows of them, from which those before are subtracted already: the first half,
/// and then the second without what the first gives to it.
bool Cholesky::factorise(Index first, Index count) {
  check_interruption();
  if (count <= undivided) {
    auto diagonal = factor_.block(first, first, count, count);
    if (Eigen::internal::llt_inplace<double, Eigen::Lower>::unblocked(diagonal) >= 0)
      return false;
    auto below = factor_.block(first + count, first, factor_.rows() - first - count, count);
    diagonal.adjoint().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
    return true;
  }
  const Index half = count / 2;
  if (!factorise(first, half))
    return false;
  subtract_products(first, half, count - half);
  return factorise(first + half, count - half);
}

/// Subtracts the products of the rows of `count` columns from the columns that follow them.
void Cholesky::subtract_products(Index first, Index count, Index columns) {
  /// Number of columns that one thread takes. Above the diagonal it writes what nobody reads.
  constexpr Index together = 48;
  const Index end = first + count, rows = factor_.rows() - end;
  for_columns(columns, together, static_cast<double>(rows) * static_cast<double>(count * columns), threads_,
              [&](Index column, Index width) {
                const Index row = end + column;
                const MatrixXd factors = -factor_.block(row, first, width, count).transpose();
                add_product(factor_.block(row, first, rows - column, count), factors,
                            factor_.block(row, row, rows - column, width));
              });
}

MatrixXd Cholesky::solve_lower(MatrixXd right_sides) const {
  for_right_sides(right_sides, threads_, [&](auto&& solved) {
    for (Index first = 0; first < factor_.rows(); first += undivided) {
      check_interruption();
      const Index count = std::min(undivided, factor_.rows() - first), rest = factor_.rows() - first - count;
      auto here = solved.middleRows(first, count);
      factor_.block(first, first, count, count).template triangularView<Eigen::Lower>().solveInPlace(here);
      if (rest > 0)
        add_product(factor_.block(first + count, first, rest, count), MatrixXd(-here),
                    solved.bottomRows(rest));
    }
  });
  return right_sides;
}

MatrixXd Cholesky::solve_upper(MatrixXd right_sides) const {
  for_right_sides(right_sides, threads_, [&](auto&& solved) {
    for (Index end = factor_.rows(); end > 0; end -= std::min(undivided, end)) {
      check_interruption();
      const Index first = end - std::min(undivided, end), count = end - first, rest = factor_.rows() - end;
      auto here = solved.middleRows(first, count);
      if (rest > 0) {
        MatrixXd products = MatrixXd::Zero(count, solved.cols());
        add_transposed_product(factor_.block(end, first, rest, count), solved.bottomRows(rest), products);
        here -= products;
      }
      factor_.block(first, first, count, count)
          .transpose()
          .template triangularView<Eigen::Upper>()
          .solveInPlace(here);
    }
  });
  return right_sides;
}

}  // namespace fringe::detail
