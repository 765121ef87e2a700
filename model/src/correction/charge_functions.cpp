#include "correction/charge_functions.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include <Eigen/QR>

#include "geometry/median_split.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Largest ratios of a function's radius to the distance at which each level but the finest suffices, for the
/// formula in closed form and for an accuracy.
using LevelRatios = std::array<double, 3>;
constexpr std::array<LevelRatios, 2> largest_ratios{LevelRatios{0.6, 1.5, 4}, LevelRatios{0.25, 0.7, 1.6}};

/// Returns a row of a matrix that may have no columns, and then no data of which a row could be a part.
Eigen::RowVectorXd row_of(const MatrixXd& matrix, std::size_t row) {
  return matrix.cols() > 0 ? Eigen::RowVectorXd(matrix.row(index_of(row))) : Eigen::RowVectorXd(0);
}

AlignedBox3d box_of(const PanelMesh& mesh, std::span<const std::size_t> panels) {
  AlignedBox3d box;
  for (const std::size_t panel : panels)
    for (const Vector3d& corner : mesh.panels()[panel].corners)
      box.extend(corner);
  return box;
}

/// Returns weights with which panels share the charge of a function: their charges with all conductors at
/// unit potential, and a small density everywhere, so that no part is without charge.
VectorXd weights_of(const ConductorsAtRest& conductors) {
  /// The least density, relative to the mean of its body.
  constexpr double least = 0.05;
  const std::vector<Panel>& panels = conductors.mesh().panels();
  VectorXd weights = conductors.charges().rowwise().sum().cwiseMax(0);
  std::vector<double> charges(conductors.bodies().bodies.size(), 0), areas = charges;
  for (const PanelGroup& group : conductors.mesh().groups())
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      charges[group.body] += weights[index_of(k)];
      areas[group.body] += panels[k].area;
    }
  for (const PanelGroup& group : conductors.mesh().groups())
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      weights[index_of(k)] += (least * charges[group.body] / areas[group.body] + 1e-12) * panels[k].area;
  return weights;
}

/// Divides panels into so many parts of nearby ones, or into single panels.
void divide(const PanelMesh& mesh, std::span<std::size_t> panels, std::size_t parts,
            std::vector<std::span<std::size_t>>& divided) {
  if (parts <= 1 || panels.size() <= 1) {
    divided.push_back(panels);
    return;
  }
  split_at_median(panels, panels.size() / 2,
                  [&](std::size_t panel) -> const Vector3d& { return mesh.panels()[panel].centre; });
  divide(mesh, panels.first(panels.size() / 2), parts / 2, divided);
  divide(mesh, panels.subspan(panels.size() / 2), parts / 2, divided);
}

void add_centres(const Triangle& triangle, std::size_t parts, std::vector<Vector3d>& centres) {
  if (parts <= 1) {
    centres.emplace_back((triangle[0] + triangle[1] + triangle[2]) / 3);
    return;
  }
  for (const Triangle& quarter : quarters(triangle))
    add_centres(quarter, parts / 4, centres);
}

/// Adds charges to those at points (rows) so that their dipole moments about `centre` become `moments` (a
/// column for each of the charges), as far as the points allow; the sums of the charges stay.
void match_moments(const std::vector<Vector3d>& points, const Vector3d& centre, double radius,
                   const MatrixXd& moments, MatrixXd& charges) {
  /// Least extent of the points in a direction, relative to the largest one, in which moments are matched:
  /// across a flat part they hardly differ.
  constexpr double least_extent = 0.1;
  MatrixXd conditions(4, index_of(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    conditions.col(index_of(k)) << 1, (points[k] - centre) / radius;
  MatrixXd missing = MatrixXd::Zero(4, charges.cols());
  missing.bottomRows(3) = moments / radius - (conditions * charges).bottomRows(3);
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver;
  solver.setThreshold(least_extent);
  solver.compute(conditions);
  charges += solver.solve(missing);
}

/// A part of a body's surface, and how important it is to divide it.
struct Candidate {
  double importance;
  std::size_t first;
  std::size_t count;
  std::size_t body;
  std::size_t whole;  ///< number of the part it belonged to when there were half as many
  bool operator<(const Candidate& other) const {
    return importance != other.importance ? importance < other.importance : first > other.first;
  }
};

}  // namespace

ChargeFunctions::ChargeFunctions(const ConductorsAtRest& conductors, const MatrixXd& given,
                                 const std::function<double(const Part&)>& importance, std::size_t most) {
  const PanelMesh& mesh = conductors.mesh();
  const VectorXd weights = weights_of(conductors);
  std::vector<std::vector<std::size_t>> of_bodies(conductors.bodies().bodies.size());
  for (const PanelGroup& group : mesh.groups())
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      of_bodies[group.body].push_back(k);
  std::vector<std::size_t> order;
  std::priority_queue<Candidate> candidates;
  const auto density = [&](std::span<const std::size_t> some) {
    double charge = 0, area = 0;
    for (const std::size_t panel : some) {
      charge += weights[index_of(panel)];
      area += mesh.panels()[panel].area;
    }
    return charge / area;
  };
  std::vector<double> densities;
  densities.reserve(of_bodies.size());
  for (const auto& panels : of_bodies)
    densities.push_back(panels.empty() ? 0 : density(panels));
  const auto add_candidate = [&](std::size_t first, std::size_t count, std::size_t body, std::size_t whole) {
    const auto panels = std::span(order).subspan(first, count);
    const double value = count > 1 ? importance({box_of(mesh, panels), density(panels), densities[body]}) : 0;
    candidates.push({value, first, count, body, whole});
  };
  const auto divide_into = [&](std::size_t number) {
    while (candidates.size() < number && candidates.top().importance > 0) {
      const auto [value, first, count, body, whole] = candidates.top();
      candidates.pop();
      split_at_median(std::span(order).subspan(first, count), count / 2,
                      [&](std::size_t panel) -> const Vector3d& { return mesh.panels()[panel].centre; });
      add_candidate(first, count / 2, body, whole);
      add_candidate(first + count / 2, count - count / 2, body, whole);
    }
    std::vector<Candidate> parts;
    for (; !candidates.empty(); candidates.pop())
      parts.push_back(candidates.top());
    std::sort(parts.begin(), parts.end(),
              [](const Candidate& a, const Candidate& b) { return a.first < b.first; });
    return parts;
  };
  for (const auto& panels : of_bodies)
    order.insert(order.end(), panels.begin(), panels.end());
  for (std::size_t body = 0, first = 0; body < of_bodies.size(); first += of_bodies[body].size(), ++body)
    if (!of_bodies[body].empty()) {
      boxes_.push_back(box_of(mesh, of_bodies[body]));
      add_candidate(first, of_bodies[body].size(), body, 0);
    }
  for (Candidate part : divide_into(most / 2)) {
    part.whole = static_cast<std::size_t>(coarse_.count++);
    candidates.push(part);
  }
  const std::vector<Candidate> parts = divide_into(most);

  const ClusterTree& tree = conductors.panel_operator().tree();
  coarse_.shares.resize(index_of(parts.size()));
  Restriction restriction{std::vector<Index>(mesh.panels().size()), VectorXd(index_of(mesh.panels().size()))};
  for (std::size_t function = 0; function < parts.size(); ++function) {
    const auto panels = std::span(order).subspan(parts[function].first, parts[function].count);
    double total = 0;
    for (const std::size_t panel : panels)
      total += weights[index_of(panel)];
    coarse_.of.push_back(index_of(parts[function].whole));
    coarse_.shares[index_of(function)] = total;
    for (const std::size_t panel : panels) {
      const Index place = tree.places()[panel];
      restriction.target[static_cast<std::size_t>(place)] = index_of(function);
      restriction.weights[place] = weights[index_of(panel)] / total;
    }
    add_function(mesh, panels, conductors.bodies().bodies[parts[function].body].conductor, weights / total,
                 given);
    panels_.first.push_back(panels_.corners.size());
    for (const std::size_t panel : panels) {
      panels_.corners.push_back(mesh.panels()[panel].corners);
      panels_.shares.push_back(static_cast<float>(weights[index_of(panel)] / total));
    }
  }
  panels_.first.push_back(order.size());
  panels_.given.resize(index_of(order.size()), given.cols());
  for (std::size_t k = 0; k < order.size() && given.cols() > 0; ++k)
    panels_.given.row(index_of(k)) = given.row(index_of(order[k])).cast<float>();
  VectorXd totals = VectorXd::Zero(coarse_.count);
  for (std::size_t function = 0; function < parts.size(); ++function)
    totals[coarse_.of[function]] += coarse_.shares[index_of(function)];
  for (std::size_t function = 0; function < parts.size(); ++function)
    coarse_.shares[index_of(function)] /= totals[coarse_.of[function]];
  energies_ = conductors.panel_operator().matrix().dense_restricted(restriction, index_of(parts.size()));
  for (std::size_t level = 0; level < points_.size(); ++level) {
    points_[level].first.push_back(points_[level].at.size());
    points_[level].given.resize(index_of(points_[level].at.size()), given.cols());
    for (std::size_t k = 0; k < given_[level].size() && given.cols() > 0; ++k)
      points_[level].given.row(index_of(k)) = given_[level][k].transpose().cast<float>();
    given_[level].clear();
  }
}

void ChargeFunctions::add_function(const PanelMesh& mesh, std::span<std::size_t> panels,
                                   std::size_t conductor, const VectorXd& weights, const MatrixXd& given) {
  const AlignedBox3d box = box_of(mesh, panels);
  centres_.emplace_back(box.center());
  double radius = 0;
  for (const std::size_t panel : panels)
    for (const Vector3d& corner : mesh.panels()[panel].corners)
      radius = std::max(radius, (corner - box.center()).norm());
  radii_.push_back(radius);
  conductors_.push_back(conductor);
  MatrixXd moments = MatrixXd::Zero(3, given.cols());
  for (const std::size_t panel : panels)
    moments += (mesh.panels()[panel].centre - box.center()) * row_of(given, panel);
  for (std::size_t level = 0; level < points_.size(); ++level) {
    const std::size_t wanted = points_per_function[level];
    std::vector<std::span<std::size_t>> parts;
    divide(mesh, panels, wanted, parts);
    std::vector<Vector3d> at;
    std::vector<double> shares;
    std::vector<Eigen::RowVectorXd> charges;
    for (const std::span<std::size_t> part : parts) {
      if (part.size() > 1 || parts.size() >= wanted) {
        Vector3d centre = Vector3d::Zero();
        double share = 0;
        Eigen::RowVectorXd charge = Eigen::RowVectorXd::Zero(given.cols());
        for (const std::size_t panel : part) {
          centre += weights[index_of(panel)] * mesh.panels()[panel].centre;
          share += weights[index_of(panel)];
          charge += row_of(given, panel);
        }
        at.emplace_back(centre / share);
        shares.push_back(share);
        charges.emplace_back(charge);
        continue;
      }
      std::vector<Vector3d> centres;
      add_centres(mesh.panels()[part[0]].corners, (wanted + parts.size() - 1) / parts.size(), centres);
      const auto count = static_cast<double>(centres.size());
      for (const Vector3d& centre : centres) {
        at.push_back(centre);
        shares.push_back(weights[index_of(part[0])] / count);
        charges.emplace_back(row_of(given, part[0]) / count);
      }
    }
    MatrixXd all(index_of(at.size()), given.cols());
    for (std::size_t k = 0; k < at.size() && all.cols() > 0; ++k)
      all.row(index_of(k)) = charges[k];
    if (level >= first_with_moments && given.cols() > 0)
      match_moments(at, box.center(), radius, moments, all);
    FunctionPoints& points = points_[level];
    points.first.push_back(points.at.size());
    for (std::size_t k = 0; k < at.size(); ++k) {
      points.at.emplace_back(at[k].cast<float>());
      points.shares.push_back(static_cast<float>(shares[k]));
      given_[level].emplace_back(row_of(all, k).transpose());
    }
  }
}

std::size_t ChargeFunctions::most_points() const {
  std::size_t most = 0;
  for (const FunctionPoints& points : points_)
    for (std::size_t function = 0; function < count(); ++function)
      most = std::max(most, points.first[function + 1] - points.first[function]);
  return most;
}

MatrixXd ChargeFunctions::net(std::size_t conductors) const {
  MatrixXd net = MatrixXd::Zero(index_of(count()), index_of(conductors));
  for (std::size_t function = 0; function < count(); ++function)
    net(index_of(function), index_of(conductors_[function])) = 1;
  return net;
}

std::size_t ChargeFunctions::level(std::size_t function, double distance, bool is_fine) const {
  const LevelRatios& ratios = largest_ratios[is_fine ? 1 : 0];
  std::size_t level = 0;
  while (level < ratios.size() && radii_[function] > ratios[level] * distance)
    ++level;
  return level;
}

}  // namespace fringe::detail
