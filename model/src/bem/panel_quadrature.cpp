#include "bem/panel_quadrature.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "numeric/quadrature_rules.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Highest degree of a rule; beyond it, two halves take fewer points than the whole.
constexpr int highest_rule_degree = 8;

/// Ratio of size to distance above which a rule needs at least the degree below. So near, the ratio says
/// little about the error of a rule of few points.
constexpr double near_ratio = 0.5;
constexpr int lowest_near_degree = 5;

/// Largest number of halvings: the parts have 2^−24 of a panel's area, a four-thousandth of its size.
constexpr int most_triangle_halvings = 24;

/// Returns the rule of lowest degree that suffices for a ratio of size to distance; null if there is none.
const TriangleRule* rule_for(double ratio, double allowed) {
  const double base = std::min(ratio, 1.0);
  double missed = 1;
  int power = 0;
  for (const TriangleRule& rule : triangle_rules()) {
    if (rule.degree > highest_rule_degree)
      break;
    // The rule of one point sees no slope, and what it misses counts twice.
    if (rule.degree < 2 || (ratio > near_ratio && rule.degree < lowest_near_degree))
      continue;
    for (; power <= rule.degree; ++power)
      missed *= base;
    if (missed <= allowed)
      return &rule;
  }
  return nullptr;
}

/// Lays the points of rules over a triangle, halved where it is too near to the singularity.
class TrianglePoints {
 public:
  TrianglePoints(double tolerance, const std::function<double(const Vector3d&)>& distance,
                 const std::function<void(const Vector3d&, double)>& point)
      : allowed_(rule_caution * tolerance / 2), distance_(distance), point_(point) {}

  void lay(const Triangle& triangle, double share, int halvings) const {
    const Vector3d centre = centre_of(triangle);
    const double squared_radius =
        std::max({(triangle[0] - centre).squaredNorm(), (triangle[1] - centre).squaredNorm(),
                  (triangle[2] - centre).squaredNorm()});
    const TriangleRule* rule = rule_for(std::sqrt(squared_radius) / distance_(centre), allowed_ / share);
    if (rule == nullptr && halvings < most_triangle_halvings) {
      for (const Triangle& half : halves(triangle, longest_side(triangle)))
        lay(half, share / 2, halvings + 1);
      return;
    }
    if (rule == nullptr)
      rule = &triangle_rule(highest_rule_degree);
    for (int k = 0; k < rule->points; ++k)
      point_(point_of(triangle, rule->nodes[k]), share * rule->nodes[k].weight);
  }

 private:
  double allowed_;
  const std::function<double(const Vector3d&)>& distance_;
  const std::function<void(const Vector3d&, double)>& point_;
};

const GaussRule& segment_rule(int points) {
  static const std::array<GaussRule, 9> rules{gauss_rule(1), gauss_rule(1), gauss_rule(2),
                                              gauss_rule(3), gauss_rule(4), gauss_rule(5),
                                              gauss_rule(6), gauss_rule(7), gauss_rule(8)};
  return rules[static_cast<std::size_t>(points)];
}

void lay_on_segment(const Vector3d& from, const Vector3d& to, double share, double allowed,
                    const std::function<double(const Vector3d&, const Vector3d&)>& distance,
                    const std::function<void(const Vector3d&, double)>& point) {
  constexpr int most_points = 8;
  /// Fewest points: even the last part, at a singularity, contains a logarithm.
  constexpr int fewest_points = 3;
  constexpr double least_share = 0x1p-20;
  const double half_length = (to - from).norm() / 2;
  // Of a panel that is tiny beside its coordinates, rounding may join a side's end with the point that
  // divides it.
  if (half_length == 0) {
    point(from, share);
    return;
  }
  const double away = distance(from, to) / half_length;
  const double parameter = away + std::sqrt(1 + away * away);
  // The slope at the singularity is logarithmic: the error of a part there falls like its squared length.
  const double digits = std::log(std::max(share * share / allowed, 1.0));
  const double wanted = digits == 0 ? 0 : digits / (2 * std::log(parameter));
  if (wanted > most_points && share > least_share) {
    const Vector3d middle = (from + to) / 2;
    lay_on_segment(from, middle, share / 2, allowed, distance, point);
    lay_on_segment(middle, to, share / 2, allowed, distance, point);
    return;
  }
  const int points =
      static_cast<int>(std::clamp(std::ceil(wanted), double{fewest_points}, double{most_points}));
  for (const GaussNode& node : segment_rule(points))
    point(from + node.position * (to - from), share * node.weight);
}

}  // namespace

double far_ratio(double tolerance, int degree) {
  return std::pow(rule_caution * tolerance / 2, 1.0 / (degree + 1));
}

void for_each_point(const Triangle& triangle, double tolerance,
                    const std::function<double(const Vector3d&)>& distance,
                    const std::function<void(const Vector3d&, double)>& point) {
  TrianglePoints(tolerance, distance, point).lay(triangle, 1, 0);
}

void for_each_point(const Vector3d& from, const Vector3d& to, double tolerance,
                    const std::function<double(const Vector3d&, const Vector3d&)>& distance,
                    const std::function<void(const Vector3d&, double)>& point) {
  lay_on_segment(from, to, 1, rule_caution * tolerance / 2, distance, point);
}

}  // namespace fringe::detail
