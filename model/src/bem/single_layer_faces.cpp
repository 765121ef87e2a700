#include "bem/single_layer_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "bem/charge_kernels.hpp"
#include "bem/patch_distance.hpp"
#include "numeric/interruption.hpp"
#include "numeric/products.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Largest number of points of a rule on the whole face. A rule with more is divided into panels, which then
/// need fewer.
constexpr int most_whole_points = 26;

/// Largest number of halvings of a panel. A distance of 2^−40 of a side is below the accuracy of poses in
/// double precision.
constexpr int most_halvings = 40;

/// Factor by which the panels of the inner rule grow, starting at the point where the potential is evaluated.
constexpr double panel_growth = 3.5;

/// Returns the number of points that a Gauss rule on [−1, 1] needs if its integrand is singular at the
/// complex x + iy. Every point divides the error by the square of the ellipse's parameter; `digits` is the
/// logarithm of the whole reduction.
double points_for_singularity(double x, double y, double digits) {
  const double sum = std::sqrt((x - 1) * (x - 1) + y * y) + std::sqrt((x + 1) * (x + 1) + y * y);
  const double parameter = (sum + std::sqrt(std::max(sum * sum - 4, 0.0))) / 2;
  return digits / (2 * std::log(std::max(parameter, 1 + 1e-12)));
}

/// Returns the number of points that polynomials of a degree need on a part of [−1, 1]. Over an angle they
/// oscillate like cosines of degree·angle, which need half as high a degree, but never more than their own.
double points_for_degree(double degree, double from, double to) {
  const double angle = std::acos(std::clamp(from, -1.0, 1.0)) - std::acos(std::clamp(to, -1.0, 1.0));
  return degree / 2 * std::min(1.0, angle / 2);
}

/// Returns the number of points that the edge weight needs on a part of [−1, 1], for its singularities at the
/// ends that the part does not reach.
double points_for_weight(double from, double to, double digits) {
  const double middle = (from + to) / 2, half_length = (to - from) / 2;
  double points = 0;
  if (from > -1)
    points = points_for_singularity((-1 - middle) / half_length, 0, digits);
  if (to < 1)
    points = std::max(points, points_for_singularity((1 - middle) / half_length, 0, digits));
  return points;
}

int limited_count(double points) {
  return std::min(static_cast<int>(std::ceil(std::min(points, 1e6))), most_points);
}

struct RulePanel {
  double from;
  double to;
  int points;
};

Index count_points(const std::vector<RulePanel>& panels) {
  Index total = 0;
  for (const RulePanel& panel : panels)
    total += panel.points;
  return total;
}

/// Writes the panels' nodes and weights to a rule with room for all their points.
void lay_panels(const std::vector<RulePanel>& panels, EdgeKind edge, int functions, DirectionRule& rule) {
  Index offset = 0;
  for (const auto& [from, to, points] : panels) {
    add_panel(rule, offset, edge, functions, from, to, points);
    offset += points;
  }
}

/// One direction of the outer face, over which is integrated last. The potential of the other face's charge
/// is smooth there, except near the other face's edges.
class OuterDirection {
 public:
  OuterDirection(const ChargedFace& face, bool along_u, int functions, int other_functions,
                 const RectangleCorners& other, double digits)
      : face_(face), along_u_(along_u), functions_(functions), other_functions_(other_functions),
        other_(other), digits_(digits) {}

  DirectionRule rule() const {
    const int whole = whole_points();
    if (whole <= most_whole_points) {
      const DirectionRule& known = whole_rule(face_.edge, whole);
      return {known.nodes, known.weights.topRows(functions_)};
    }
    std::vector<RulePanel> panels;
    halve(-1, 1, 0, panels);
    const Index points = count_points(panels);
    DirectionRule laid{Eigen::VectorXd(points), Eigen::MatrixXd(functions_, points)};
    lay_panels(panels, face_.edge, functions_, laid);
    return laid;
  }

 private:
  double half() const { return along_u_ ? face_.half_u : face_.half_v; }

  /// Returns the distance, in half sides, of the other face's edges from the part of this face between two
  /// values of the coordinate.
  double distance(double from, double to) const {
    Eigen::Vector2d low(-face_.half_u, -face_.half_v), high(face_.half_u, face_.half_v);
    const Index axis = along_u_ ? 0 : 1;
    low[axis] = from * half();
    high[axis] = to * half();
    return edge_distance(low, high, axis, other_) / half();
  }

  int whole_points() const {
    /// Ends of sections of a half side: narrow towards its end, where the ellipses are narrow, too.
    constexpr std::array<double, 6> cuts{0, 0.5, 0.8, 0.93, 0.98, 1};
    double most = 0;
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
      for (const double side : {-1.0, 1.0}) {
        const double near = side * cuts[k], far = side * cuts[k + 1];
        const double away = distance(std::min(near, far), std::max(near, far));
        most = std::max(most, points_for_singularity(cuts[k], away, digits_));
      }
    return limited_count(1 + functions_ / 2.0 + most + std::min(2 * most, other_functions_ / 2.0));
  }

  void halve(double from, double to, int halvings, std::vector<RulePanel>& panels) const {
    const double half_length = (to - from) / 2, away = distance(from, to);
    /// Distance in half lengths below which two halves need no more points together than the whole.
    constexpr double close = 0.45;
    // One halving at least: a panel may reach the weight's singularity at one end only.
    if (halvings == 0 || (away < close * half_length && halvings < most_halvings)) {
      halve(from, from + half_length, halvings + 1, panels);
      halve(from + half_length, to, halvings + 1, panels);
      return;
    }
    const double own = points_for_degree(functions_, from, to);
    const double others = std::max(0.2 * other_functions_, points_for_degree(other_functions_, from, to));
    const double singular = std::max(points_for_singularity(0, away / half_length, digits_),
                                     points_for_weight(from, to, digits_));
    panels.push_back({from, to, limited_count(1 + own + singular + others)});
  }

  const ChargedFace& face_;
  bool along_u_;
  int functions_;
  int other_functions_;
  const RectangleCorners& other_;
  double digits_;
};

/// One direction of the inner face, over which is integrated first, for one evaluation point after the other.
/// The kernel is singular at `at` ± i·height in the complex plane of the coordinate.
class InnerDirection {
 public:
  InnerDirection(EdgeKind edge, int functions, double digits)
      : edge_(edge), functions_(functions),
        digits_(digits), own_{{}, Eigen::MatrixXd(whole_face_blocks(functions), 0)} {}

  /// Returns the rule for an evaluation point, valid until the next call.
  RuleView seen_from(double at, double height) {
    const int whole = limited_count(1 + functions_ / 2.0 + points_for_singularity(at, height, digits_));
    if (whole <= most_whole_points)
      return view(whole_rule(edge_, whole), whole);
    cut(at, height);
    return view(own_, lay(panels_));
  }

 private:
  RuleView view(const DirectionRule& rule, Index points) const {
    return {points, functions_, rule.weights.rows(), rule.nodes.data(), rule.weights.data()};
  }

  Index lay(const std::vector<RulePanel>& panels) {
    const Index points = count_points(panels);
    if (points > own_.nodes.size()) {
      own_.nodes.resize(2 * points);
      own_.weights.setZero(own_.weights.rows(), 2 * points);
    }
    lay_panels(panels, edge_, functions_, own_);
    return points;
  }

  void cut(double at, double height) {
    panels_.clear();
    // One panel must not extend from end to end: the weight is singular at both.
    const double first = std::clamp(2 * height, std::ldexp(1.0, -most_halvings), 1.0);
    // A panel boundary close to an end would come too near to the weight's singularity there.
    double centre = std::clamp(at, -1.0, 1.0);
    if (1 - std::abs(centre) < first / 2)
      centre = std::copysign(1.0, centre);
    for (const double side : {-1.0, 1.0}) {
      const double length = 1 - side * centre;
      if (length == 0)
        continue;
      // Panels in a geometric sequence from the first one's end to the end of the face.
      const int more = length <= 1.5 * first
                           ? 0
                           : static_cast<int>(std::ceil(std::log(length / first) / std::log(panel_growth)));
      const double growth = more == 0 ? 1 : std::pow(length / first, 1.0 / more);
      double near = centre;
      for (int k = 0; k <= more; ++k) {
        // Exactly the end of the face, which add_panel recognises.
        const double far = k == more ? side : centre + side * first * std::pow(growth, k);
        const auto [from, to] = std::minmax(near, far);
        const double middle = (from + to) / 2, half_length = (to - from) / 2;
        const double singular =
            std::max(points_for_singularity((at - middle) / half_length, height / half_length, digits_),
                     points_for_weight(from, to, digits_));
        panels_.push_back({from, to, limited_count(1 + points_for_degree(functions_, from, to) + singular)});
        near = far;
      }
    }
  }

  EdgeKind edge_;
  int functions_;
  double digits_;
  std::vector<RulePanel> panels_;
  DirectionRule own_;  ///< with room for more nodes than are in use
};

RectangleCorners corners_seen_from(const ChargedFace& face, const ChargedFace& other) {
  const Vector3d normal = face.axis_u.cross(face.axis_v);
  const auto seen = [&](double u, double v) {
    const Vector3d point =
        other.centre + u * other.half_u * other.axis_u + v * other.half_v * other.axis_v - face.centre;
    return Vector3d(point.dot(face.axis_u), point.dot(face.axis_v), point.dot(normal));
  };
  return {seen(-1, -1), seen(1, -1), seen(1, 1), seen(-1, 1)};
}

struct OuterRule {
  DirectionRule u;
  DirectionRule v;
  Index nodes() const { return u.nodes.size() * v.nodes.size(); }
};

OuterRule outer_rule(const ChargedFace& face, FaceFunctions functions, const ChargedFace& other,
                     FaceFunctions other_functions, double digits) {
  const RectangleCorners corners = corners_seen_from(face, other);
  const int degree = std::max(other_functions.u, other_functions.v);
  return {OuterDirection(face, true, functions.u, degree, corners, digits).rule(),
          OuterDirection(face, false, functions.v, degree, corners, digits).rule()};
}

/// Evaluates the potentials of all functions of a face at points.
class InnerPotential {
 public:
  InnerPotential(const ChargedFace& face, FaceFunctions functions, double digits)
      : face_(face), normal_(face.axis_u.cross(face.axis_v)), u_(face.edge, functions.u, digits),
        v_(face.edge, functions.v, digits) {}

  /// Computes the potentials of f_k(x)·f_l(y) at a point, in element l + k·functions.v.
  void at(const Vector3d& point, double* potentials) {
    const Vector3d offset = point - face_.centre;
    const double x = offset.dot(face_.axis_u), y = offset.dot(face_.axis_v), z = offset.dot(normal_);
    const double beside_u = std::max(std::abs(x) - face_.half_u, 0.0);
    const double beside_v = std::max(std::abs(y) - face_.half_v, 0.0);
    const RuleView along_u = u_.seen_from(x / face_.half_u, std::hypot(z, beside_v) / face_.half_u);
    const RuleView along_v = v_.seen_from(y / face_.half_v, std::hypot(z, beside_u) / face_.half_v);
    if (const std::size_t room = face_scratch(along_u, along_v); room > scratch_.size())
      scratch_.resize(2 * room);
    best_kernels<ChargeKernels>().face_potentials({x, y, z, face_.half_u, face_.half_v}, along_u, along_v,
                                                  scratch_.data(), potentials);
  }

 private:
  const ChargedFace& face_;
  Vector3d normal_;
  InnerDirection u_;
  InnerDirection v_;
  std::vector<double> scratch_;
};

/// Integrates the inner face's potentials over the outer face. Rows are the inner face's functions, columns
/// the outer's.
Eigen::MatrixXd integral(const ChargedFace& outer, FaceFunctions outer_functions, const OuterRule& rule,
                         const ChargedFace& inner, FaceFunctions inner_functions, double digits) {
  const Eigen::MatrixXd weights_u = rule.u.weights.topRows(outer_functions.u).transpose(),
                        weights_v = rule.v.weights.topRows(outer_functions.v).transpose();
  InnerPotential potential(inner, inner_functions, digits);
  const Index count = whole_face_blocks(inner_functions.count());
  /// Number of lines whose sums stay in the cache until they are added up.
  constexpr Index lines = 8;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, outer_functions.count());
  Eigen::MatrixXd along_v = Eigen::MatrixXd::Zero(count, rule.v.nodes.size());
  Eigen::MatrixXd summed(count * outer_functions.v, lines);
  Eigen::Map<Eigen::MatrixXd> sums(result.data(), summed.rows(), outer_functions.u);
  for (Index first = 0; first < rule.u.nodes.size(); first += lines) {
    check_interruption();
    const Index here = std::min(lines, rule.u.nodes.size() - first);
    summed.setZero();
    for (Index i = 0; i < here; ++i) {
      const Vector3d line = outer.centre + outer.half_u * rule.u.nodes[first + i] * outer.axis_u;
      for (Index j = 0; j < rule.v.nodes.size(); ++j)
        potential.at(line + outer.half_v * rule.v.nodes[j] * outer.axis_v, along_v.col(j).data());
      add_product(along_v, weights_v,
                  Eigen::Map<Eigen::MatrixXd>(summed.col(i).data(), count, outer_functions.v));
    }
    add_product(summed.leftCols(here), weights_u.middleRows(first, here), sums);
  }
  return result.topRows(inner_functions.count());
}

/// Returns the logarithm by which the rules have to reduce the error. The ellipses tell how fast the error
/// falls, not where it starts: near an edge it starts at three times the elements, for which 10 is safe.
double digits_for(double tolerance) {
  constexpr double start = 10;
  return std::log(start / tolerance);
}

}  // namespace

Eigen::MatrixXd single_layer_block(const ChargedFace& first, FaceFunctions first_functions,
                                   const ChargedFace& second, FaceFunctions second_functions,
                                   double tolerance) {
  const double digits = digits_for(tolerance);
  const OuterRule over_first = outer_rule(first, first_functions, second, second_functions, digits);
  const OuterRule over_second = outer_rule(second, second_functions, first, first_functions, digits);
  if (over_first.nodes() < over_second.nodes())
    return integral(first, first_functions, over_first, second, second_functions, digits).transpose();
  return integral(second, second_functions, over_second, first, first_functions, digits);
}

Eigen::MatrixXd face_potentials(const ChargedFace& face, FaceFunctions functions,
                                std::span<const Vector3d> points, double tolerance) {
  InnerPotential potential(face, functions, digits_for(tolerance));
  Eigen::MatrixXd result(functions.count(), static_cast<Index>(points.size()));
  for (Index k = 0; k < result.cols(); ++k) {
    check_interruption();
    potential.at(points[static_cast<std::size_t>(k)], result.col(k).data());
  }
  return result;
}

}  // namespace fringe::detail
