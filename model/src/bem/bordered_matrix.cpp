#include "bem/bordered_matrix.hpp"

#include <algorithm>

#include "numeric/parallel.hpp"
#include "numeric/products.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// Calls task(first, count) for consecutive parts of a range, on several threads.
template <class Task>
void parallel_parts(Index size, std::size_t threads, const Task& task) {
  /// Number of rows in a part: their products take longer than a thread needs to begin.
  constexpr Index together = 128;
  parallel_for(static_cast<std::size_t>((size + together - 1) / together), threads, [&](std::size_t part) {
    const Index first = static_cast<Index>(part) * together;
    task(first, std::min(together, size - first));
  });
}

}  // namespace

MatrixXd BorderedMatrix::apply(const MatrixXd& factors) const {
  const Index count = functions.rows();
  const auto of_functions = factors.topRows(count), of_unknowns = factors.bottomRows(unknowns.size());
  MatrixXd result(factors.rows(), factors.cols());
  result.bottomRows(unknowns.size()) = unknowns.apply(of_unknowns);
  if (count > 0) {
    parallel_parts(count, unknowns.threads(), [&](Index first, Index rows) {
      auto part = result.middleRows(first, rows);
      part.setZero();
      add_product(functions.middleRows(first, rows), of_functions, part);
      add_product(coupling.middleRows(first, rows), of_unknowns, part);
    });
    parallel_parts(unknowns.size(), unknowns.threads(), [&](Index first, Index rows) {
      add_transposed_product(coupling.middleCols(first, rows), of_functions,
                             result.middleRows(count + first, rows));
    });
  }
  if (present.size() > 0)
    result.array().colwise() *= present.array();
  return result;
}

}  // namespace fringe::detail
