#include "compression.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "elimination.hpp"
#include "monomials.hpp"

namespace fringe::detail {
namespace {

/// The coordinates are scaled to the size a node has in units of its distance when its quadrature is of most
/// use: the monomials are then weighed as they enter the error.
constexpr double working_ratio = 0.25;

/// A monomial of which less than this is left when those before it are matched is not matched: it would cost
/// a point and gain less than the remainder of the series.
constexpr double smallest_pivot = 1e-5;

/// How far below zero a weight may fall, as a share of the mean weight of a point, so that points are
/// exchanged through coefficients that are not small.
constexpr double slack_share = 1e-3;

/// Points are not exchanged through smaller coefficients, which would multiply what weights have fallen below
/// zero.
constexpr double smallest_coefficient = 1e-3;

/// The linear system of the moments: a column per candidate, a row per monomial. Reduced by elimination it is
/// the tableau of the simplex method: some candidates are basic, one for each row, and every other column
/// says how the weights of the basic ones change when weight is taken from its candidate.
class Tableau {
 public:
  Tableau(const std::vector<WeightedPoint>& candidates, const CompressionFrame& frame, int degree)
      : candidates_(candidates), free_(candidates.size()) {
    std::iota(free_.begin(), free_.end(), std::size_t{0});
    fill(frame, degree);
  }

  std::vector<WeightedPoint> solve() {
    basic_.assign(rows_, no_candidate);
    weights_.assign(stride_, 0);
    reduce();
    double total = 0;
    for (const WeightedPoint& candidate : candidates_)
      total += candidate.weight;
    slack_ = slack_share * total / static_cast<double>(rows_);
    while (!free_.empty())
      release(free_.back());
    std::vector<WeightedPoint> points;
    for (std::size_t row = 0; row < rows_; ++row)
      if (basic_[row] != no_candidate)
        points.push_back({candidates_[basic_[row]].position, weights_[row]});
    return points;
  }

 private:
  static constexpr std::size_t no_candidate = static_cast<std::size_t>(-1);

  double* column(std::size_t candidate) { return columns_.data() + candidate * stride_; }
  const double* column(std::size_t candidate) const { return columns_.data() + candidate * stride_; }

  /// The values of the monomials that are anywhere large enough to be matched.
  void fill(const CompressionFrame& frame, int degree) {
    const std::size_t count = monomial_count(degree);
    std::vector<double> all(candidates_.size() * count);
    MonomialValues values{}, largest{};
    const Eigen::Matrix3d to_frame = frame.axes.transpose() * (working_ratio / frame.radius);
    for (std::size_t j = 0; j < candidates_.size(); ++j) {
      evaluate_monomials(to_frame * (candidates_[j].position - frame.centre), degree, values);
      std::copy_n(values.begin(), count, all.begin() + static_cast<std::ptrdiff_t>(j * count));
      for (std::size_t i = 0; i < count; ++i)
        largest[i] = std::max(largest[i], std::abs(values[i]));
    }
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < count; ++i)
      if (largest[i] >= smallest_pivot)
        kept.push_back(i);
    rows_ = kept.size();
    stride_ = (rows_ + column_padding - 1) / column_padding * column_padding;
    columns_.assign(candidates_.size() * stride_, 0);
    for (std::size_t j = 0; j < candidates_.size(); ++j)
      for (std::size_t i = 0; i < rows_; ++i)
        column(j)[i] = all[j * count + kept[i]];
  }

  /// Gauss–Jordan elimination, a monomial at a time. A row of which hardly anything is left has no basic
  /// candidate.
  void reduce() {
    std::size_t chosen = largest_in_row(0);
    for (std::size_t row = 0; row < rows_ && !free_.empty(); ++row) {
      const std::size_t candidate = free_[chosen];
      if (std::abs(column(candidate)[row]) < smallest_pivot) {
        for (const std::size_t j : free_)
          column(j)[row] = 0;
        chosen = row + 1 < rows_ ? largest_in_row(row + 1) : 0;
        continue;
      }
      free_.erase(free_.begin() + static_cast<std::ptrdiff_t>(chosen));
      chosen = eliminate(row, candidate, std::min(row + 1, rows_ - 1));
      basic_[row] = candidate;
      weights_[row] = candidates_[candidate].weight;
    }
  }

  /// The place in the list of the free candidate with the largest value in the row.
  std::size_t largest_in_row(std::size_t row) const {
    std::size_t largest = 0;
    for (std::size_t k = 1; k < free_.size(); ++k)
      if (std::abs(column(free_[k])[row]) > std::abs(column(free_[largest])[row]))
        largest = k;
    return largest;
  }

  /// Makes the candidate basic for the row; returns what largest_in_row returns afterwards for the next one.
  std::size_t eliminate(std::size_t row, std::size_t candidate, std::size_t next) {
    return eliminate_columns({columns_.data(), stride_}, free_, column(candidate), row, next);
  }

  /// Takes the weight of the last free candidate down to zero; where that would drive the weight of a basic
  /// one below zero, the two change places (Carathéodory's theorem).
  void release(std::size_t candidate) {
    free_.pop_back();
    const double* const coefficients = column(candidate);
    const double weight = candidates_[candidate].weight;
    const std::optional<std::size_t> leaving = blocking(coefficients, weight);
    double step = weight;
    if (leaving)
      step = weights_[*leaving] / -coefficients[*leaving];
    for (std::size_t i = 0; i < stride_; ++i)
      weights_[i] += coefficients[i] * step;
    if (!leaving)
      return;
    eliminate(*leaving, candidate, *leaving);
    basic_[*leaving] = candidate;
    weights_[*leaving] = weight - step;
  }

  /// The basic candidate that stands in the way of taking a free one's weight down to zero. Among those that
  /// reach zero at about the same time it is the one with the largest coefficient: the others may fall a
  /// little below zero, but the exchange loses no digits (P. M. J. Harris, Mathematical Programming 5, 1973,
  /// 1).
  std::optional<std::size_t> blocking(const double* coefficients, double weight) const {
    // A coefficient that is too small, or positive, leaves a denominator that makes the quotient larger than
    // any weight.
    constexpr double smallest_denominator = 1e-300, smallest_share = 1e-3;
    const auto size = static_cast<Eigen::Index>(stride_);
    const Eigen::Map<const Eigen::ArrayXd> below(coefficients, size), weights(weights_.data(), size);
    const double step = ((weights + slack_).max(smallest_share * slack_) /
                         (-below - smallest_coefficient).max(smallest_denominator))
                            .minCoeff();
    if (step >= weight)
      return std::nullopt;
    std::optional<std::size_t> result;
    double largest = smallest_coefficient;
    for (std::size_t row = 0; row < rows_; ++row) {
      if (-coefficients[row] > largest && weights_[row] <= -coefficients[row] * step) {
        largest = -coefficients[row];
        result = row;
      }
    }
    return result;
  }

  const std::vector<WeightedPoint>& candidates_;
  std::vector<std::size_t> free_;
  std::vector<std::size_t> basic_;  ///< by row
  std::size_t rows_ = 0;
  std::size_t stride_ = 0;
  std::vector<double> columns_;
  std::vector<double> weights_;  ///< of the basic candidates, by row
  double slack_ = 0;
};

}  // namespace

std::vector<WeightedPoint> compress(const std::vector<WeightedPoint>& candidates,
                                    const CompressionFrame& frame, int degree) {
  return Tableau(candidates, frame, degree).solve();
}

}  // namespace fringe::detail
