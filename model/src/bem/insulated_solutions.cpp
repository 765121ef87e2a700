#include "bem/insulated_solutions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "fringe/interruption.hpp"
#include "numeric/gmres.hpp"
#include "numeric/interruption.hpp"
#include "numeric/parallel.hpp"
#include "numeric/products.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Number of functions that are factorised in little time.
constexpr Index most_factorised = 1500;

/// Returns the space in which all unknowns are as they are.
CombinedFunctions whole_space(const InsulatedUnknowns& unknowns) {
  const Index size = unknowns.size();
  CombinedFunctions result{{}, VectorXd::Ones(size), VectorXd::Ones(size), size};
  for (Index k = 0; k < size; ++k)
    result.place.push_back(k);
  return result;
}

/// Returns a space of the coarse space's functions in a leaf that are on the same body and alike, `together`
/// at a time.
CombinedFunctions clusters_of(const InsulatedUnknowns& unknowns, const InsulatedMatrix& matrix,
                              Index together) {
  CombinedFunctions result{{}, unknowns.areas, VectorXd::Ones(unknowns.size()), 0};
  std::vector<Index> cluster(static_cast<std::size_t>(unknowns.coarse.size), -1);
  std::vector<double> whole;
  for (std::size_t leaf = 0; leaf < matrix.leaves(); ++leaf) {
    const ClusterRange own = matrix.leaf(leaf);
    std::vector<Index> first;  // of each cluster of these functions, one of its unknowns
    Index functions = 0;
    for (Index k = own.first; k < own.first + own.count; ++k) {
      const auto at = static_cast<std::size_t>(k);
      Index& place = cluster[static_cast<std::size_t>(unknowns.coarse.place[at])];
      if (place < 0) {
        if (functions++ == together) {
          functions = 1;
          first.clear();
        }
        const auto alike = std::find_if(first.begin(), first.end(), [&](Index other) {
          return unknowns.body[at] == unknowns.body[static_cast<std::size_t>(other)] &&
                 unknowns.states[at] == unknowns.states[static_cast<std::size_t>(other)];
        });
        if (alike == first.end()) {
          first.push_back(k);
          place = result.size++;
          whole.push_back(0);
        } else {
          place = result.place[static_cast<std::size_t>(*alike)];
        }
      }
      result.place.push_back(place);
      whole[static_cast<std::size_t>(place)] += unknowns.areas[k];
    }
  }
  for (Index k = 0; k < unknowns.size(); ++k) {
    result.shares[k] /= whole[static_cast<std::size_t>(result.place[static_cast<std::size_t>(k)])];
    if (unknowns.is_charge(k))
      result.parts[k] = result.shares[k];
  }
  return result;
}

/// Returns the functions of a coarser space as combinations of those of a space.
CombinedFunctions within(const CombinedFunctions& space, const CombinedFunctions& coarser) {
  CombinedFunctions result{std::vector<Index>(static_cast<std::size_t>(space.size)),
                           VectorXd::Zero(space.size), VectorXd::Zero(space.size), coarser.size};
  for (std::size_t k = 0; k < space.place.size(); ++k) {
    const Index place = space.place[k];
    result.place[static_cast<std::size_t>(place)] = coarser.place[k];
    result.shares[place] += coarser.shares[index_of(k)];
    result.parts[place] = coarser.parts[index_of(k)] / space.parts[index_of(k)];
  }
  return result;
}

/// Returns the unknowns of a leaf, and those next to it with all that are combined with them in the coarse
/// space.
std::vector<Index> around_leaf(const InsulatedUnknowns& unknowns, const InsulatedMatrix& matrix,
                               std::size_t leaf) {
  /// Distance of panels next to each other, relative to the sum of their sizes, and largest number of
  /// functions of the coarse space that a leaf is given: more take longer than they save.
  constexpr double next = 1.2;
  constexpr std::size_t most = 24;
  const ClusterRange own = matrix.leaf(leaf);
  const VectorXd sizes = unknowns.areas.segment(own.first, own.count).cwiseSqrt();
  const auto distance = [&](Index k) {
    const double size = std::sqrt(unknowns.areas[k]);
    return ((unknowns.centres.middleCols(own.first, own.count).colwise() - unknowns.centres.col(k))
                .colwise()
                .norm()
                .transpose()
                .array() /
            (sizes.array() + size))
        .minCoeff();
  };
  std::map<Index, double> nearest;  // functions of the coarse space
  for (const std::size_t near : matrix.leaves_near(leaf)) {
    const ClusterRange others = near == leaf ? ClusterRange{} : matrix.leaf(near);
    for (Index k = others.first; k < others.first + others.count; ++k)
      if (const double own_distance = distance(k); own_distance <= next) {
        const Index place = unknowns.coarse.place[static_cast<std::size_t>(k)];
        const auto [known, is_new] = nearest.try_emplace(place, own_distance);
        known->second = std::min(known->second, own_distance);
      }
  }
  std::vector<std::pair<double, Index>> chosen;
  chosen.reserve(nearest.size());
  for (const auto& [place, own_distance] : nearest)
    chosen.emplace_back(own_distance, place);
  std::sort(chosen.begin(), chosen.end());
  chosen.resize(std::min(chosen.size(), most));
  std::vector<Index> result;
  for (Index k = own.first; k < own.first + own.count; ++k)
    result.push_back(k);
  for (const std::size_t near : matrix.leaves_near(leaf)) {
    const ClusterRange others = near == leaf ? ClusterRange{} : matrix.leaf(near);
    for (Index k = others.first; k < others.first + others.count; ++k) {
      const Index place = unknowns.coarse.place[static_cast<std::size_t>(k)];
      if (std::any_of(chosen.begin(), chosen.end(), [&](const auto& one) { return one.second == place; }))
        result.push_back(k);
    }
  }
  return result;
}

/// A Schwarz method of two levels: solves in a space of few functions, and for what is missing then with the
/// functions of each leaf and those next to it, of which the leaf's own are kept (a restricted additive
/// method, Cai and Sarkis 1999).
class TwoLevels {
 public:
  TwoLevels(const InsulatedUnknowns& unknowns, const InsulatedMatrix& matrix, const CombinedFunctions& space,
            const CombinedFunctions& clusters, std::size_t threads)
      : matrix_(matrix), space_(space), clusters_(within(space, clusters)),
        coarse_(matrix.combined(clusters)), leaves_(matrix.leaves()), threads_(threads) {
    parallel_for(leaves_.size(), threads, [&](std::size_t leaf) {
      if (matrix.leaf(leaf).count > 0)
        leaves_[leaf] = factorised(around_leaf(unknowns, matrix, leaf), matrix.leaf(leaf).count);
    });
  }

  /// Returns the product of the matrix of the space with values at its places.
  MatrixXd times(const MatrixXd& values) const { return space_.means(matrix_.times(space_.spread(values))); }

  MatrixXd solve(const MatrixXd& residuals) const {
    MatrixXd result = clusters_.spread(coarse_.solve(clusters_.means(residuals)));
    const MatrixXd left = residuals - times(result);
    parallel_for(leaves_.size(), threads_, [&](std::size_t k) {
      const Leaf& leaf = leaves_[k];
      if (leaf.own.count == 0)
        return;
      const MatrixXd around = left(leaf.places, Eigen::all);
      add_product(MatrixReference<double>(leaf.inverse), around,
                  result.middleRows(leaf.own.first, leaf.own.count));
    });
    return result;
  }

 private:
  struct Leaf {
    ClusterRange own;           ///< its places
    std::vector<Index> places;  ///< these and those next to it
    MatrixXd inverse;           ///< rows of its own places
  };

  /// `unknowns` are those of a leaf, so many, and those next to it.
  Leaf factorised(const std::vector<Index>& unknowns, Index own) const {
    Leaf leaf;
    CombinedFunctions part{{}, space_.shares(unknowns), space_.parts(unknowns), 0};
    std::map<Index, Index> numbers;
    for (const Index k : unknowns) {
      const Index place = space_.place[static_cast<std::size_t>(k)];
      const auto [number, is_new] = numbers.try_emplace(place, part.size);
      if (is_new) {
        leaf.places.push_back(place);
        ++part.size;
      }
      part.place.push_back(number->second);
    }
    // The places of a leaf's unknowns follow each other.
    const auto last = std::max_element(part.place.begin(), part.place.begin() + own);
    leaf.own = {leaf.places.front(), 1 + *last};
    const MatrixXd rows = part.means(matrix_.block(unknowns));
    MatrixXd block = MatrixXd::Zero(part.size, part.size);
    for (Index k = 0; k < rows.cols(); ++k)
      block.col(part.place[static_cast<std::size_t>(k)]) += part.parts[k] * rows.col(k);
    // The rows of the inverse are the columns of that of the transposed block.
    leaf.inverse =
        block.transpose().partialPivLu().solve(MatrixXd::Identity(part.size, leaf.own.count)).transpose();
    return leaf;
  }

  const InsulatedMatrix& matrix_;
  const CombinedFunctions& space_;
  CombinedFunctions clusters_;
  Eigen::PartialPivLU<MatrixXd> coarse_;
  std::vector<Leaf> leaves_;
  std::size_t threads_;
};

/// Returns the values at the places of a space; by iteration from so many functions on, and for each right
/// side so many. Throws Interrupted if that does not converge and factorisation would take minutes.
MatrixXd solved_in(const InsulatedUnknowns& unknowns, const InsulatedMatrix& matrix,
                   const CombinedFunctions& space, const MatrixXd& right_sides, Index least_functions,
                   std::size_t threads) {
  constexpr Index least_per_column = 60;
  /// Largest residual, relative to the right side: far below the accuracy that can be asked for.
  constexpr double residual = 1e-7;
  constexpr int most_steps = 400;
  /// Largest number of functions that are factorised, in seconds, where the iteration does not converge.
  constexpr Index most_instead = 6000;
  const MatrixXd means = space.means(right_sides);
  if (space.size >= std::max(least_functions, least_per_column * right_sides.cols())) {
    const Index together = (unknowns.coarse.size + most_factorised - 1) / most_factorised;
    const TwoLevels preconditioner(unknowns, matrix, space, clusters_of(unknowns, matrix, together), threads);
    const auto solution = gmres(
        [&](const MatrixXd& values) {
          check_interruption();
          return preconditioner.times(values);
        },
        [&](const MatrixXd& residuals) { return preconditioner.solve(residuals); }, means, residual,
        most_steps);
    if (solution)
      return *solution;
    if (space.size > most_instead)
      throw Interrupted();
  }
  return matrix.combined(space).partialPivLu().solve(means);
}

}  // namespace

InsulatedSolutions solved(const InsulatedUnknowns& unknowns, const InsulatedMatrix& matrix,
                          const MatrixXd& right_sides, std::size_t threads) {
  /// Number of unknowns from which on the iteration takes less time than a factorisation.
  constexpr Index least_unknowns = 1200;
  const CombinedFunctions& coarse = unknowns.coarse;
  InsulatedSolutions result;
  result.fine = solved_in(unknowns, matrix, whole_space(unknowns), right_sides, least_unknowns, threads);
  result.coarse =
      coarse.spread(solved_in(unknowns, matrix, coarse, right_sides, most_factorised + 1, threads));
  result.details = result.fine - coarse.spread(coarse.combined(result.fine));
  return result;
}

}  // namespace fringe::detail
