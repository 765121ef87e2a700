#include "bem/double_layer.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "bem/panel_pair.hpp"
#include "bem/panel_quadrature.hpp"
#include "numeric/parallel.hpp"
#include "numeric/quadrature_rules.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Distance from a source's plane, relative to the source's size, below which a target lies in it.
constexpr double in_plane = 1e-9;

/// Degree of the rule for panels that are far apart, of three points.
constexpr int far_degree = 2;

/// A source with what its far field needs: dipoles at the points of a rule.
struct Dipoles {
  std::vector<Vector3d> points;
  Vector3d moment;  ///< the panel's normal times its area over 4π, times the weight of one point
};

Dipoles dipoles_of(const Panel& panel, const TriangleRule& rule) {
  const Vector3d second = panel.corners[1] - panel.corners[0], third = panel.corners[2] - panel.corners[0];
  Dipoles result{{}, second.cross(third) / (8 * std::numbers::pi)};
  for (int k = 0; k < rule.points; ++k)
    result.points.push_back(point_of(panel.corners, rule.nodes[k]));
  return result;
}

bool lies_in_plane(const Panel& target, const Panel& source, const Vector3d& normal) {
  const double tolerance = in_plane * source.radius;
  return std::all_of(target.corners.begin(), target.corners.end(), [&](const Vector3d& corner) {
    return std::abs(normal.dot(corner - source.centre)) <= tolerance;
  });
}

double far_element(const std::vector<Vector3d>& target, const Dipoles& source, const TriangleRule& rule) {
  double sum = 0;
  for (int row = 0; row < rule.points; ++row)
    for (int column = 0; column < rule.points; ++column) {
      const Vector3d away =
          source.points[static_cast<std::size_t>(column)] - target[static_cast<std::size_t>(row)];
      const double squared = away.squaredNorm();
      sum += rule.nodes[row].weight * rule.nodes[column].weight * source.moment.dot(away) /
             (squared * std::sqrt(squared));
    }
  return sum;
}

void add_near_element(const Panel& target, const Panel& source, double tolerance, PotentialSums& angles,
                      double& sum) {
  const double safe = 2 * source.radius;
  const auto distance = [&](const Vector3d& point) {
    const double centres = (point - source.centre).norm();
    return centres > safe ? centres - source.radius : outline_distance(source.corners, point);
  };
  const auto lay = [&](const Vector3d& point, double weight) {
    angles.add(source.corners, point, weight, sum);
  };
  // By reference, because a copy of the lambda would copy what it captures for every pair.
  for_each_point(target.corners, tolerance, std::ref(distance), std::ref(lay));
}

}  // namespace

DoubleLayer double_layer_of(std::span<const Panel> targets, std::span<const Panel> panels,
                            const std::vector<bool>& is_source, double tolerance, const KnownAngles& known,
                            std::size_t threads) {
  const double farthest = 1 / far_ratio(tolerance, far_degree);
  const TriangleRule& rule = triangle_rule(far_degree);
  std::vector<std::size_t> sources;
  std::vector<Dipoles> dipoles;
  std::vector<Vector3d> normals;
  DoubleLayer result;
  for (std::size_t k = 0; k < panels.size(); ++k) {
    result.columns.push_back(is_source[k] ? static_cast<Index>(sources.size()) : -1);
    if (!is_source[k])
      continue;
    sources.push_back(k);
    dipoles.push_back(dipoles_of(panels[k], rule));
    normals.push_back(dipoles.back().moment.normalized());
  }
  const auto place = [&](std::size_t panel) { return known.places.empty() ? -1 : known.places[panel]; };
  const auto size = static_cast<Index>(sources.size());
  result.elements.resize(static_cast<Index>(targets.size()), size);
  if (sources.empty())
    return result;
  /// Number of rows that one thread evaluates at a time.
  constexpr std::size_t together = 16;
  parallel_for((targets.size() + together - 1) / together, threads, [&](std::size_t block) {
    const std::size_t first = block * together, rows = std::min(together, targets.size() - first);
    // Elements of a row follow each other while they are evaluated.
    MatrixXd transposed = MatrixXd::Zero(size, static_cast<Index>(rows));
    PotentialSums angles = PotentialSums::of_solid_angles();
    for (std::size_t row = first; row < first + rows; ++row) {
      const Panel& target = targets[row];
      const std::vector<Vector3d> points = dipoles_of(target, rule).points;
      double* const elements = transposed.col(static_cast<Index>(row - first)).data();
      for (std::size_t k = 0; k < sources.size(); ++k) {
        const Panel& source = panels[sources[k]];
        const double reach = farthest * (target.radius + source.radius);
        if (place(row) >= 0 && place(sources[k]) >= 0)
          elements[k] = known.matrix(place(row), place(sources[k]));
        else if ((target.centre - source.centre).squaredNorm() > reach * reach)
          elements[k] = far_element(points, dipoles[k], rule);
        else if (!lies_in_plane(target, source, normals[k]))
          add_near_element(target, source, tolerance, angles, elements[k]);
      }
    }
    angles.flush();
    result.elements.middleRows(static_cast<Index>(first), static_cast<Index>(rows)) = transposed.transpose();
  });
  return result;
}

}  // namespace fringe::detail
