#include "bem/face_self_interaction.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/interruption.hpp"
#include "numeric/parallel.hpp"

namespace fringe::detail {
namespace {

// Numbers of quadrature points. Half as many more change no element of a matrix by more than 5e-10 of the
// largest, for sides of 1 to 40 (self_interaction_test); oscillating functions need more points.
int distance_points(int functions) {
  return 118 + 3 * functions / 2;
}
int overlap_points(int functions) {
  return 64 + 4 * functions;
}
/// Half the range of the tanh-sinh rule over the overlap, in its variable t.
constexpr double overlap_reach = 4.0;

/// Returns a rule on [0, 1] for integrands with any singularity at 1 and a kernel that is singular at 0 in
/// several directions at once. From 1 it is a tanh-sinh rule; towards 0 the logarithm of the distance changes
/// more slowly, first by equal steps, because 1/√(u² + v²) is analytic only for |Im ln(u/v)| < π/2.
TanhSinhRule corner_rule(int points) {
  constexpr double from = -5.13, to = 3.5;
  const double step = (to - from) / (points - 1);
  TanhSinhRule rule;
  for (int i = 0; i < points; ++i) {
    const double t = from + i * step, grow = std::exp(t), fall = 0.2 * std::exp(-t);
    const double s = 2 * t + grow - fall;
    const double from_left = 1 / (1 + std::exp(-s)), from_right = 1 / (1 + std::exp(s));
    rule.from_left.push_back(from_left);
    rule.from_right.push_back(from_right);
    rule.weights.push_back(step * (2 + grow + fall) * from_left * from_right);
  }
  return rule;
}

/// Computes the matrix of all ∫f_i(x)·f_k(x − u) dx for 0 < u < 2, by a quadrature rule over the x of the
/// overlap. `rest` is 2 − u.
Eigen::MatrixXd correlations(EdgeKind edge, int functions, double u, double rest,
                             const TanhSinhRule& overlap) {
  const WeightedPolynomials& polynomials = weighted_polynomials(edge);
  const auto count = static_cast<Eigen::Index>(overlap.weights.size());
  Eigen::MatrixXd here(functions, count), there(functions, count);
  for (Eigen::Index q = 0; q < count; ++q) {
    // x runs from u − 1 to 1, and y = x − u from −1 to 1 − u.
    const auto at = static_cast<std::size_t>(q);
    const double left = rest * overlap.from_left[at], right = rest * overlap.from_right[at];
    polynomials.evaluate(right < left ? 1 - right : u - 1 + left, functions, here.col(q).data());
    polynomials.evaluate(right < left ? rest - 1 - right : left - 1, functions, there.col(q).data());
    // The product of the weights at x and y.
    here.col(q) *= edge_weight(edge, (u + left) * left, right * (u + right)) * rest * overlap.weights[at];
  }
  return here * there.transpose();
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

DistanceRule::DistanceRule(EdgeKind edge, int functions, double more_points) {
  const auto scaled = [&](int points) { return static_cast<int>(more_points * points); };
  const TanhSinhRule nodes = corner_rule(scaled(distance_points(functions)));
  const TanhSinhRule overlap = tanh_sinh_rule(scaled(overlap_points(functions)), overlap_reach);
  const EvenPairs pairs(functions);
  const auto count = static_cast<Eigen::Index>(nodes.weights.size());
  distance.resize(count);
  correlation.resize(pairs.size(), count);
  function.resize(functions, count);
  for (Eigen::Index q = 0; q < count; ++q) {
    check_interruption();
    const auto at = static_cast<std::size_t>(q);
    const double left = 2 * nodes.from_left[at], right = 2 * nodes.from_right[at];
    const double weight = 2 * nodes.weights[at];
    distance[q] = left;
    const Eigen::MatrixXd all = correlations(edge, functions, left, right, overlap);
    for (Eigen::Index p = 0; p < pairs.size(); ++p)
      correlation(p, q) = weight * all(pairs[p].first, pairs[p].second);
    weighted_polynomials(edge).evaluate(left - 1, functions, function.col(q).data());
    function.col(q) *= weight * edge_weight(edge, left, right);
  }
}

const DistanceRule& distance_rule(EdgeKind edge, int functions) {
  static std::array<LazyArray<DistanceRule, most_functions / 2 + 1>, 2> rules;
  const int half = functions / 2;
  return rules[edge == EdgeKind::thin ? 0 : 1].at(static_cast<std::size_t>(half),
                                                  [&] { return DistanceRule(edge, 2 * half + 1); });
}

Eigen::MatrixXd parallel_faces(const DistanceRule& rule, FaceFunctions first, FaceFunctions second, double a,
                               double b, double distance) {
  const Eigen::Index count_u = EvenPairs(std::max(first.u, second.u)).size();
  const Eigen::Index count_v = EvenPairs(std::max(first.v, second.v)).size();
  const Eigen::ArrayXd along = (a * rule.distance).square() + distance * distance;
  const Eigen::ArrayXd across = (b * rule.distance).square();
  Eigen::MatrixXd kernel(across.size(), along.size());
  for (Eigen::Index q = 0; q < along.size(); ++q)
    kernel.col(q) = (across + along[q]).rsqrt();
  const Eigen::MatrixXd potentials = rule.correlation.topRows(count_v) * kernel;
  const Eigen::MatrixXd sums = rule.correlation.topRows(count_u) * potentials.transpose();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(first.count(), second.count());
  for (int i = 0; i < first.u; ++i)
    for (int k = i % 2; k < second.u; k += 2)
      for (int j = 0; j < first.v; ++j)
        for (int l = j % 2; l < second.v; l += 2)
          result(i * first.v + j, k * second.v + l) =
              4 * sums(EvenPairs::index(i, k), EvenPairs::index(j, l));
  return result;
}

Eigen::MatrixXd face_self_interaction(const ChargedFace& face, FaceFunctions functions) {
  const DistanceRule& rule = distance_rule(face.edge, std::max(functions.u, functions.v));
  return parallel_faces(rule, functions, functions, face.half_u, face.half_v, 0);
}

}  // namespace fringe::detail
