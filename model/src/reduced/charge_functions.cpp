#include "reduced/charge_functions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "geometry/box_tree.hpp"
#include "surface/bodies.hpp"
#include "surface/round_shape.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Largest ratios of a function's radius to the distance at which each level but the finest suffices.
constexpr std::array<double, 3> largest_ratios{0.25, 0.7, 1.6};

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

/// Brings the panels on the one side of a flat part to the front and returns their number; 0 if the part is
/// not flat. The two sides of a thin body lie close together, but what is before one of them displaces charge
/// there and not on the other. Sides are told by their places: normals may point to either side.
std::size_t split_sides(const PanelMesh& mesh, std::span<std::size_t> panels) {
  /// Largest thickness of a flat part, relative to the width of its sides, and the least one: a sheet has one
  /// side here.
  constexpr double thickest = 0.3, thinnest = 1e-3;
  /// Largest deviation of the panels from two planes, the root of the mean square over the thickness.
  constexpr double most_curved = 0.2;
  /// Least part of a normal along the common one with which a panel belongs to a side.
  constexpr double least_part = 0.5;
  const auto normal_of = [&](std::size_t panel) -> Vector3d {
    const auto& [a, b, c] = mesh.panels()[panel].corners;
    return (b - a).cross(c - a).stableNormalized();
  };
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const std::size_t panel : panels)
    squares += mesh.panels()[panel].area * normal_of(panel) * normal_of(panel).transpose();
  const Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squares).eigenvectors().col(2);
  const auto height_of = [&](std::size_t panel) { return axis.dot(mesh.panels()[panel].centre); };
  std::vector<std::size_t> flat;
  for (const std::size_t panel : panels)
    if (std::abs(normal_of(panel).dot(axis)) >= least_part)
      flat.push_back(panel);
  if (flat.empty())
    return 0;
  const auto [lowest, highest] = std::minmax_element(
      flat.begin(), flat.end(), [&](std::size_t a, std::size_t b) { return height_of(a) < height_of(b); });
  const double middle = (height_of(*lowest) + height_of(*highest)) / 2;
  /// Sums over a side: of areas, of heights above the middle, and of their squares.
  struct Side {
    double area = 0, heights = 0, squares = 0;
  };
  Side above, below;
  for (const std::size_t panel : flat) {
    const double area = mesh.panels()[panel].area, height = height_of(panel) - middle;
    Side& side = height > 0 ? above : below;
    side.area += area;
    side.heights += area * height;
    side.squares += area * height * height;
  }
  if (above.area == 0 || below.area == 0)
    return 0;
  const double thickness = above.heights / above.area - below.heights / below.area,
               width = std::sqrt((above.area + below.area) / 2);
  const auto deviation = [](const Side& side) {
    const double mean = side.heights / side.area;
    return side.squares / side.area - mean * mean;
  };
  const double allowed = most_curved * thickness;
  if (thickness > thickest * width || thickness < thinnest * width ||
      std::max(deviation(above), deviation(below)) > allowed * allowed)
    return 0;
  const auto others = std::stable_partition(panels.begin(), panels.end(), [&](std::size_t panel) {
    return height_of(panel) > middle && std::abs(normal_of(panel).dot(axis)) >= least_part;
  });
  return static_cast<std::size_t>(others - panels.begin());
}

/// Divides the panels of a part into two, and returns the number of the first ones: the sides of a flat part,
/// else halves along its longest side.
std::size_t split(const PanelMesh& mesh, std::span<std::size_t> panels) {
  if (const std::size_t on_side = split_sides(mesh, panels); on_side > 0)
    return on_side;
  split_at_median(panels, panels.size() / 2,
                  [&](std::size_t panel) -> const Vector3d& { return mesh.panels()[panel].centre; });
  return panels.size() / 2;
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

/// Returns the dipole moments about a centre of charges at points (rows), a column for each of the charges.
MatrixXd moments_of(const std::vector<Vector3d>& points, const Vector3d& centre, const MatrixXd& charges) {
  MatrixXd moments = MatrixXd::Zero(3, charges.cols());
  for (std::size_t k = 0; k < points.size(); ++k)
    moments += (points[k] - centre) * charges.row(index_of(k));
  return moments;
}

/// Adds charges to those at points (rows) so that their dipole moments about `centre` become `moments` (a
/// column for each of the charges), with a pair of points more in each direction in which the points hardly
/// differ; the sums of the charges stay.
void match_moments(const Vector3d& centre, double radius, const MatrixXd& moments,
                   std::vector<Vector3d>& points, MatrixXd& charges) {
  /// Least extent of the points in a direction, relative to the largest one, in which their charges can have
  /// moments.
  constexpr double least_extent = 0.1;
  /// Distance of the added points from the centre, over the radius.
  constexpr double arm = 0.25;
  /// Part of the moments that rounding may leave.
  constexpr double rounding = 1e-9;
  MatrixXd conditions(4, index_of(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    conditions.col(index_of(k)) << 1, (points[k] - centre) / radius;
  MatrixXd missing = MatrixXd::Zero(4, charges.cols());
  missing.bottomRows(3) = (moments - moments_of(points, centre, charges)) / radius;
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver;
  solver.setThreshold(least_extent);
  solver.compute(conditions);
  charges += solver.solve(missing);
  const MatrixXd left = moments - moments_of(points, centre, charges);
  for (Index axis = 0; axis < 3; ++axis) {
    if (left.row(axis).norm() <= rounding * radius * charges.norm())
      continue;
    charges.conservativeResize(charges.rows() + 2, Eigen::NoChange);
    for (const double sign : {1.0, -1.0}) {
      points.emplace_back(centre + sign * arm * radius * Vector3d::Unit(axis));
      charges.row(index_of(points.size()) - 1) = sign / (2 * arm * radius) * left.row(axis);
    }
  }
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
  const auto divide_into = [&](std::size_t number, double least) {
    while (candidates.size() < number && candidates.top().importance > least) {
      const auto [value, first, count, body, whole] = candidates.top();
      candidates.pop();
      const std::size_t in_first = split(mesh, std::span(order).subspan(first, count));
      add_candidate(first, in_first, body, whole);
      add_candidate(first + in_first, count - in_first, body, whole);
    }
    std::vector<Candidate> parts;
    for (; !candidates.empty(); candidates.pop())
      parts.push_back(candidates.top());
    std::sort(parts.begin(), parts.end(),
              [](const Candidate& a, const Candidate& b) { return a.first < b.first; });
    return parts;
  };
  // Returns the greatest importance of the parts when there are as many as there may be.
  const auto greatest_importance = [&] {
    const std::priority_queue<Candidate> undivided = candidates;
    double greatest = 0;
    for (const Candidate& part : divide_into(most, 0))
      greatest = std::max(greatest, part.importance);
    candidates = undivided;
    return greatest;
  };
  for (const auto& panels : of_bodies)
    order.insert(order.end(), panels.begin(), panels.end());
  for (std::size_t body = 0, first = 0; body < of_bodies.size(); first += of_bodies[body].size(), ++body)
    if (!of_bodies[body].empty()) {
      boxes_.push_back(box_of(mesh, of_bodies[body]));
      add_candidate(first, of_bodies[body].size(), body, 0);
    }
  // A halving divides an importance, a square of sizes, by 1.6 to 2.5: these parts are halved once at least.
  constexpr double once = 2.5;
  for (Candidate part : divide_into(most / 2, once * greatest_importance())) {
    part.whole = static_cast<std::size_t>(coarse_.count++);
    candidates.push(part);
  }
  const std::vector<Candidate> parts = divide_into(most, 0);

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
  find_facets(conductors, given, order);
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
  for (const std::size_t panel : panels) {
    moments += (mesh.panels()[panel].centre - box.center()) * row_of(given, panel);
  }
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
      int quarterings = 0;
      for (std::size_t of_panel = (wanted + parts.size() - 1) / parts.size(); of_panel > 1; of_panel /= 4)
        ++quarterings;
      std::vector<Vector3d> centres;
      add_centres_of_parts(mesh.panels()[part[0]].corners, quarterings, centres);
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
      match_moments(box.center(), radius, moments, at, all);
    // Added points have moments of the given charges only.
    shares.resize(at.size(), 0);
    FunctionPoints& points = points_[level];
    points.first.push_back(points.at.size());
    for (std::size_t k = 0; k < at.size(); ++k) {
      points.at.emplace_back(at[k].cast<float>());
      points.shares.push_back(static_cast<float>(shares[k]));
      given_[level].emplace_back(row_of(all, k).transpose());
    }
  }
}

void ChargeFunctions::find_facets(const ConductorsAtRest& conductors, const MatrixXd& given,
                                  const std::vector<std::size_t>& order) {
  const PanelMesh& mesh = conductors.mesh();
  VectorXd lacks = VectorXd::Zero(index_of(mesh.panels().size()));
  for (const PanelGroup& group : mesh.groups())
    if (const RoundShape* const round = round_shape_of(conductors.bodies().bodies[group.body].surface);
        round != nullptr)
      for (std::size_t k = group.first; k < group.first + group.count; ++k)
        lacks[index_of(k)] = error_per_facet_effect * round->lack_per_squared_charge(mesh.panels()[k]);
  facets_.setZero(index_of(count()));
  for (std::size_t function = 0; function < count(); ++function)
    for (std::size_t k = panels_.first[function]; k < panels_.first[function + 1]; ++k)
      facets_[index_of(function)] +=
          static_cast<float>(lacks[index_of(order[k])]) * panels_.shares[k] * panels_.shares[k];
  for (Index load = 0; load < given.cols(); ++load) {
    // At unit potential the charges of one sign are the capacitance.
    const double capacitance = given.col(load).cwiseMax(0).sum();
    if (capacitance > 0)
      facet_effect_of_given_ =
          std::max(facet_effect_of_given_, given.col(load).cwiseAbs2().dot(lacks) / capacitance);
  }
}

double ChargeFunctions::facet_effect(const Eigen::Ref<const Eigen::VectorXf>& charges,
                                     const Eigen::Ref<const Eigen::VectorXf>& others) const {
  const Index functions = facets_.size();
  return static_cast<double>(
      (facets_.array() * charges.head(functions).array().abs() * others.head(functions).array().abs()).sum());
}

MatrixXd ChargeFunctions::net(std::size_t conductors) const {
  MatrixXd net = MatrixXd::Zero(index_of(count()), index_of(conductors));
  for (std::size_t function = 0; function < count(); ++function)
    net(index_of(function), index_of(conductors_[function])) = 1;
  return net;
}

std::size_t ChargeFunctions::level(std::size_t function, const Eigen::Isometry3d& to_others,
                                   std::span<const AlignedBox3d> others) const {
  const Vector3d centre = to_others * centres_[function];
  double nearest = std::numeric_limits<double>::infinity();
  for (const AlignedBox3d& box : others)
    nearest = std::min(nearest, box.squaredExteriorDistance(centre));
  const double distance = std::sqrt(nearest);
  std::size_t level = 0;
  while (level < largest_ratios.size() && radii_[function] > largest_ratios[level] * distance)
    ++level;
  return level;
}

}  // namespace fringe::detail
