#include "integral/tree/compression.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "integral/tree/kernels.hpp"
#include "integral/tree/moments.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

/// Size to which a node's radius is scaled: the ratio of radius to distance at which its quadrature is most
/// useful. The monomials then have the weight with which they enter the error.
constexpr double working_ratio = 0.25;

/// Pivot size below which a monomial is not matched. It would cost a point and gain less than the remainder
/// of the series.
constexpr double smallest_pivot = 1e-5;

/// Share of the points' mean weight by which a weight may fall below zero, so that candidates are exchanged
/// through coefficients that are not small.
constexpr double slack_share = 1e-3;

/// Smallest coefficient through which candidates are exchanged. Smaller ones would amplify the negative parts
/// of weights.
constexpr double smallest_coefficient = 1e-3;

/// Number of groups per equation when points are first compressed in groups. With fewer groups hardly any can
/// be dropped; with more the elimination costs more than it saves.
constexpr std::size_t groups_per_equation = 2;

/// Matrix with one column per candidate, which contains the values of the matched monomials.
struct Columns {
  std::size_t rows = 0;
  std::size_t stride = 0;
  std::vector<double> values;

  void resize(std::size_t columns) { values.assign(columns * stride, 0); }
  double* operator[](std::size_t index) { return values.data() + index * stride; }
  const double* operator[](std::size_t index) const { return values.data() + index * stride; }
};

/// Evaluates, at all candidates, the monomials that are large enough somewhere to be matched.
Columns columns_of(const std::vector<WeightedPoint>& candidates, const CompressionFrame& frame, int degree) {
  const MonomialRows all(candidates, frame.centre, frame.axes.transpose() * (working_ratio / frame.radius),
                         degree, MonomialRows::Factor::one);
  std::vector<const double*> kept;
  for (std::size_t i = 0; i < all.row_count(); ++i) {
    const double* const row = all.row(i);
    if (std::any_of(row, row + candidates.size(), [](double x) { return std::abs(x) >= smallest_pivot; }))
      kept.push_back(row);
  }
  Columns columns{kept.size(), (kept.size() + array_padding - 1) / array_padding * array_padding, {}};
  columns.resize(candidates.size());
  for (std::size_t j = 0; j < candidates.size(); ++j)
    for (std::size_t i = 0; i < columns.rows; ++i)
      columns[j][i] = kept[i][j];
  return columns;
}

/// The linear system of the moment equations: one column per candidate, one row per monomial. After
/// elimination it is the tableau of the simplex method: each row has a basic candidate, and every other
/// column states how the weights of the basic candidates change when weight is taken from its own candidate.
class Tableau {
 public:
  Tableau(Columns columns, std::vector<double> candidate_weights)
      : columns_(std::move(columns)), candidate_weights_(std::move(candidate_weights)),
        free_(candidate_weights_.size()), basic_(columns_.rows, no_candidate), weights_(columns_.stride) {
    std::iota(free_.begin(), free_.end(), std::size_t{0});
  }

  /// Computes weights, most of them 0, that give the same moments.
  std::vector<double> solve() {
    reduce();
    double total = 0;
    for (const double weight : candidate_weights_)
      total += weight;
    slack_ = slack_share * total / static_cast<double>(columns_.rows);
    while (!free_.empty())
      release(free_.back());
    std::vector<double> result(candidate_weights_.size());
    for (std::size_t row = 0; row < columns_.rows; ++row)
      if (basic_[row] != no_candidate)
        result[basic_[row]] = weights_[row];
    return result;
  }

 private:
  static constexpr std::size_t no_candidate = static_cast<std::size_t>(-1);

  /// Performs Gauss–Jordan elimination, one monomial at a time. A row that nearly vanishes gets no basic
  /// candidate.
  void reduce() {
    std::size_t chosen = largest_in_row(0);
    for (std::size_t row = 0; row < columns_.rows && !free_.empty(); ++row) {
      const std::size_t candidate = free_[chosen];
      if (std::abs(columns_[candidate][row]) < smallest_pivot) {
        for (const std::size_t j : free_)
          columns_[j][row] = 0;
        chosen = row + 1 < columns_.rows ? largest_in_row(row + 1) : 0;
        continue;
      }
      free_.erase(free_.begin() + static_cast<std::ptrdiff_t>(chosen));
      chosen = eliminate(row, candidate, std::min(row + 1, columns_.rows - 1));
      basic_[row] = candidate;
      weights_[row] = candidate_weights_[candidate];
    }
  }

  /// Returns the position in the list of free candidates of the one with the largest absolute value in the
  /// row.
  std::size_t largest_in_row(std::size_t row) const {
    std::size_t largest = 0;
    for (std::size_t k = 1; k < free_.size(); ++k)
      if (std::abs(columns_[free_[k]][row]) > std::abs(columns_[free_[largest]][row]))
        largest = k;
    return largest;
  }

  /// Makes the candidate basic for the row. Returns the result of largest_in_row for the row `next` after the
  /// elimination.
  std::size_t eliminate(std::size_t row, std::size_t candidate, std::size_t next) {
    return kernels_.eliminate({columns_.values.data(), columns_.stride}, free_.data(), free_.size(),
                              columns_[candidate], row, next);
  }

  /// Reduces the weight of the last free candidate to zero. Where that would make the weight of a basic
  /// candidate negative, the two change places (Carathéodory's theorem).
  void release(std::size_t candidate) {
    free_.pop_back();
    const double* const coefficients = columns_[candidate];
    const double weight = candidate_weights_[candidate];
    const std::optional<std::size_t> leaving = blocking(coefficients, weight);
    double step = weight;
    if (leaving)
      step = weights_[*leaving] / -coefficients[*leaving];
    for (std::size_t i = 0; i < columns_.stride; ++i)
      weights_[i] += coefficients[i] * step;
    if (!leaving)
      return;
    eliminate(*leaving, candidate, *leaving);
    basic_[*leaving] = candidate;
    weights_[*leaving] = weight - step;
  }

  /// Finds the basic candidate whose weight reaches zero first when a free candidate's weight is reduced to
  /// zero, if there is one. Among those that reach zero at about the same time it returns the one with the
  /// largest coefficient: the others may fall slightly below zero, but the exchange loses no digits (P. M. J.
  /// Harris, Mathematical Programming 5, 1973, 1).
  std::optional<std::size_t> blocking(const double* coefficients, double weight) const {
    const double step =
        kernels_.longest_step(coefficients, weights_.data(), slack_, smallest_coefficient, columns_.stride);
    if (step >= weight)
      return std::nullopt;
    std::optional<std::size_t> result;
    double largest = smallest_coefficient;
    for (std::size_t row = 0; row < columns_.rows; ++row) {
      if (-coefficients[row] > largest && weights_[row] <= -coefficients[row] * step) {
        largest = -coefficients[row];
        result = row;
      }
    }
    return result;
  }

  Columns columns_;
  std::vector<double> candidate_weights_;
  std::vector<std::size_t> free_;
  std::vector<std::size_t> basic_;  ///< basic candidate of each row
  std::vector<double> weights_;     ///< weight of each row's basic candidate
  double slack_ = 0;
  const TreeKernels& kernels_ = best_kernels<TreeKernels>();
};

/// The candidates that still have weight, in a few groups of neighbours. Each group counts as one candidate.
struct Groups {
  std::vector<std::size_t> first;  ///< positions of the groups' first candidates, and the list's end
  Columns columns;
  std::vector<double> weights;
};

/// Forms the groups. A group's column is the weighted mean of its candidates' columns.
Groups group(const Columns& columns, const std::vector<std::size_t>& listed,
             const std::vector<double>& weights) {
  const std::size_t most = groups_per_equation * columns.rows;
  const std::size_t count = std::min(listed.size(), most);
  Groups groups{{}, {columns.rows, columns.stride, {}}, std::vector<double>(count)};
  groups.columns.resize(count);
  groups.first.reserve(count + 1);
  for (std::size_t g = 0; g <= count; ++g)
    groups.first.push_back(listed.size() * g / count);
  for (std::size_t g = 0; g < count; ++g) {
    double* const mean = groups.columns[g];
    for (std::size_t k = groups.first[g]; k < groups.first[g + 1]; ++k)
      groups.weights[g] += weights[listed[k]];
    for (std::size_t k = groups.first[g]; k < groups.first[g + 1]; ++k) {
      const double share =
          groups.first[g + 1] - groups.first[g] == 1 ? 1 : weights[listed[k]] / groups.weights[g];
      const double* const column = columns[listed[k]];
      for (std::size_t i = 0; i < columns.stride; ++i)
        mean[i] += share * column[i];
    }
  }
  return groups;
}

}  // namespace

std::vector<WeightedPoint> compress(const std::vector<WeightedPoint>& candidates,
                                    const CompressionFrame& frame, int degree) {
  const Columns columns = columns_of(candidates, frame, degree);
  std::vector<double> weights;
  weights.reserve(candidates.size());
  for (const WeightedPoint& candidate : candidates)
    weights.push_back(candidate.weight);
  std::vector<std::size_t> listed(candidates.size());
  std::iota(listed.begin(), listed.end(), std::size_t{0});
  for (bool single = false; !single;) {
    Groups groups = group(columns, listed, weights);
    single = groups.weights.size() == listed.size();
    const std::vector<double> before = groups.weights;
    const std::vector<double> after = Tableau(std::move(groups.columns), std::move(groups.weights)).solve();
    std::vector<std::size_t> left;
    for (std::size_t g = 0; g < after.size(); ++g) {
      for (std::size_t k = groups.first[g]; k < groups.first[g + 1] && after[g] != 0; ++k) {
        weights[listed[k]] = single ? after[g] : weights[listed[k]] * (after[g] / before[g]);
        left.push_back(listed[k]);
      }
    }
    listed = std::move(left);
  }
  std::vector<WeightedPoint> points;
  points.reserve(listed.size());
  for (const std::size_t j : listed)
    points.push_back({candidates[j].position, weights[j]});
  return points;
}

}  // namespace fringe::detail
