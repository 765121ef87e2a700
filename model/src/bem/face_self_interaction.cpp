#include "bem/face_self_interaction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

// Numbers of quadrature points. Half as many more change no element of a matrix by more than 1e-9 of the
// largest, for sides of 1 to 40 (self_interaction_test); oscillating functions need more points.
int slope_points(int functions) {
  return 52 + 2 * functions;
}
int difference_points(int functions) {
  return 48 + 4 * functions;
}
/// Half the ranges of the tanh-sinh rules in their variable t.
constexpr double slope_reach = 3.2;
constexpr double difference_reach = 3.4;
constexpr double overlap_reach = 4.0;

/// Numbers of functions for which tables are cached. 7 functions reach 0.1 % in most set-ups; a table of all
/// functions takes a second to make.
constexpr std::array<int, 3> table_sizes{9, 17, most_functions};

template <EdgeKind edge>
const FaceSelfInteraction& self_table_of(int functions) {
  if (functions <= table_sizes[0]) {
    static const FaceSelfInteraction table(edge, table_sizes[0]);
    return table;
  }
  if (functions <= table_sizes[1]) {
    static const FaceSelfInteraction table(edge, table_sizes[1]);
    return table;
  }
  static const FaceSelfInteraction table(edge, table_sizes[2]);
  return table;
}

}  // namespace

EvenPairs::EvenPairs(int functions) {
  for (int k = 0; k < functions; ++k)
    for (int i = k % 2; i <= k; i += 2)
      pairs_.emplace_back(i, k);
}

Eigen::Index EvenPairs::index(int i, int k) {
  const int smaller = std::min(i, k), larger = std::max(i, k);
  // Before (·, larger) come ⌊k/2⌋ + 1 pairs for each smaller k.
  const int half = larger / 2;
  const int before = larger % 2 == 0 ? half * (half + 1) : (half + 1) * (half + 1);
  return before + smaller / 2;
}

Eigen::VectorXd correlations(EdgeKind edge, const EvenPairs& pairs, int functions, double u, double rest,
                             const TanhSinhRule& overlap) {
  const WeightedPolynomials& polynomials = weighted_polynomials(edge);
  std::array<double, most_functions> here{}, there{};
  Eigen::VectorXd result = Eigen::VectorXd::Zero(pairs.size());
  for (std::size_t q = 0; q < overlap.weights.size(); ++q) {
    // x runs from u − 1 to 1, and y = x − u from −1 to 1 − u.
    const double left = rest * overlap.from_left[q], right = rest * overlap.from_right[q];
    const double weight =
        edge_weight(edge, u + left, right) * edge_weight(edge, left, u + right) * rest * overlap.weights[q];
    polynomials.evaluate(right < left ? 1 - right : u - 1 + left, functions, here.data());
    polynomials.evaluate(right < left ? rest - 1 - right : left - 1, functions, there.data());
    for (Eigen::Index p = 0; p < pairs.size(); ++p) {
      const auto [i, k] = pairs[p];
      result[p] += weight * here[static_cast<std::size_t>(i)] * there[static_cast<std::size_t>(k)];
    }
  }
  return result;
}

TanhSinhRule overlap_rule(int functions) {
  return tanh_sinh_rule(difference_points(functions), overlap_reach);
}

FaceSelfInteraction::FaceSelfInteraction(EdgeKind edge, int functions, double more_points) {
  const auto scaled = [&](int points) { return static_cast<int>(more_points * points); };
  const EvenPairs pairs(functions);
  const TanhSinhRule slopes = tanh_sinh_rule(scaled(slope_points(functions)), slope_reach);
  const TanhSinhRule differences = tanh_sinh_rule(scaled(difference_points(functions)), difference_reach);
  const TanhSinhRule overlap = tanh_sinh_rule(scaled(difference_points(functions)), overlap_reach);
  const auto count = static_cast<Eigen::Index>(differences.weights.size());
  Eigen::MatrixXd along(pairs.size(), count), across(pairs.size(), count);
  for (Eigen::Index q = 0; q < count; ++q) {
    const auto at = static_cast<std::size_t>(q);
    along.col(q) = 2 * differences.weights[at] *
                   correlations(edge, pairs, functions, 2 * differences.from_left[at],
                                2 * differences.from_right[at], overlap);
  }
  for (std::size_t t = 0; t < slopes.weights.size(); ++t) {
    for (Eigen::Index q = 0; q < count; ++q) {
      check_interruption();
      const auto at = static_cast<std::size_t>(q);
      const double u = 2 * differences.from_left[at] * slopes.from_left[t];
      // 2 − ut from distances, which keep their relative accuracy near 0.
      const double rest = 2 * (differences.from_right[at] + differences.from_left[at] * slopes.from_right[t]);
      across.col(q) = correlations(edge, pairs, functions, u, rest, overlap);
    }
    slopes_.push_back(slopes.from_left[t]);
    moments_.emplace_back(slopes.weights[t] * along * across.transpose());
  }
}

Eigen::MatrixXd FaceSelfInteraction::matrix(int functions_u, int functions_v, double a, double b) const {
  const Eigen::Index count_u = EvenPairs(functions_u).size(), count_v = EvenPairs(functions_v).size();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(count_u, count_v);
  for (std::size_t t = 0; t < slopes_.size(); ++t) {
    sums += moments_[t].topLeftCorner(count_u, count_v) / std::hypot(a, b * slopes_[t]);
    sums += moments_[t].topLeftCorner(count_v, count_u).transpose() / std::hypot(a * slopes_[t], b);
  }
  const Eigen::Index count = Eigen::Index{functions_u} * functions_v;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, count);
  for (int i = 0; i < functions_u; ++i)
    for (int k = i % 2; k < functions_u; k += 2)
      for (int j = 0; j < functions_v; ++j)
        for (int l = j % 2; l < functions_v; l += 2)
          result(i * functions_v + j, k * functions_v + l) =
              4 * sums(EvenPairs::index(i, k), EvenPairs::index(j, l));
  return result;
}

const FaceSelfInteraction& face_self_interaction(EdgeKind edge, int functions) {
  return edge == EdgeKind::thin ? self_table_of<EdgeKind::thin>(functions)
                                : self_table_of<EdgeKind::right_angle>(functions);
}

}  // namespace fringe::detail
