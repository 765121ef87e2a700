#include "formula/charged_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>

#include <Eigen/LU>
#include <Eigen/QR>

#include "geometry/box_tree.hpp"
#include "integral/kernel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Approximate number of cells of a surface: a plate has 6 × 6.
constexpr double cells_per_surface = 36;

/// Limit of cells along one side of a long patch.
constexpr int most_cells_along = 16;

/// Limit of nodes. In surfaces of more cells neighbours are merged, since a matrix of 128 unknowns takes a
/// millisecond.
constexpr std::size_t most_nodes = 128;

/// Ratio of the own capacitance computed by collocation, with constant charge on so few cells, to the true
/// one: the mean over plates of all shapes. For a box it is 0.982.
constexpr double coarseness = 0.9765;

/// Mean of 1/r over pairs of points of a square of side 1: (4/3)(1 + 3 asinh 1 − √2).
constexpr double square_self_potential = 2.9732;

/// A triangle, or a parallelogram with the corners corner, corner + u, corner + u + v, corner + v.
struct Patch {
  Vector3d corner;
  Vector3d u;
  Vector3d v;
  bool parallelogram;

  double area() const { return u.cross(v).norm() / (parallelogram ? 1 : 2); }
  Vector3d centre() const { return corner + (u + v) / (parallelogram ? 2 : 3); }
};

/// Returns the patches of a surface: one parallelogram for two consecutive triangles that form one, otherwise
/// single triangles.
std::vector<Patch> patches_of(std::span<const Triangle> triangles) {
  constexpr double rounding = 1e-9;
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& [p, q, r] = triangles[i];
    if (i + 1 < triangles.size()) {
      const auto& [p2, r2, s] = triangles[i + 1];
      if (p2 == p && r2 == r && (p + r - q - s).norm() <= rounding * (r - p).norm()) {
        patches.push_back({p, q - p, s - p, true});
        ++i;
        continue;
      }
    }
    patches.push_back({p, q - p, r - p, false});
  }
  return patches;
}

/// Returns a border of the cells along a side (0 … 1), which are graded towards the edges, where the charge
/// is.
double strip_border(int index, int count) {
  return (1 - std::cos(std::numbers::pi * index / count)) / 2;
}

int cells_along(double length, double cell) {
  constexpr double rounding = 1e-9;
  return std::clamp(static_cast<int>(std::ceil(length / cell - rounding)), 1, most_cells_along);
}

/// Divides a needle: a triangle so much longer than high that the distribution of its charge across it does
/// not matter. Makes a row of parallelograms along its longest side, each as high as the triangle in their
/// middle. Similar triangles would lie so close together that the potentials at their centres could not
/// distinguish their charges.
void divide_needle(const Vector3d& start, const Vector3d& end, const Vector3d& apex,
                   std::vector<Patch>& cells) {
  const Vector3d side = end - start;
  const double foot = std::clamp((apex - start).dot(side) / side.squaredNorm(), 0.0, 1.0);
  const Vector3d height = apex - start - foot * side;
  for (int i = 0; i < most_cells_along; ++i) {
    const double from = strip_border(i, most_cells_along), to = strip_border(i + 1, most_cells_along);
    const double middle = (from + to) / 2;
    const double share = middle < foot ? middle / foot : (1 - middle) / (1 - foot);
    cells.push_back({start + from * side, (to - from) * side, share * height, true});
  }
}

/// Ratio of the longest side to the height above which a triangle is a needle.
constexpr double needle = 300;

/// Divides a patch into cells of about the given size.
void divide(const Patch& patch, double cell, std::vector<Patch>& cells) {
  if (patch.parallelogram) {
    const int count_u = cells_along(patch.u.norm(), cell), count_v = cells_along(patch.v.norm(), cell);
    for (int i = 0; i < count_u; ++i) {
      for (int j = 0; j < count_v; ++j) {
        const double u0 = strip_border(i, count_u), u1 = strip_border(i + 1, count_u),
                     v0 = strip_border(j, count_v), v1 = strip_border(j + 1, count_v);
        cells.push_back(
            {patch.corner + u0 * patch.u + v0 * patch.v, (u1 - u0) * patch.u, (v1 - v0) * patch.v, true});
      }
    }
    return;
  }
  const std::array<Vector3d, 3> corners{patch.corner, patch.corner + patch.u, patch.corner + patch.v};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d &start = corners[i], &end = corners[(i + 1) % 3], &apex = corners[(i + 2) % 3];
    const double squared_length = (end - start).squaredNorm();
    if (squared_length >= (apex - start).squaredNorm() && squared_length >= (apex - end).squaredNorm() &&
        squared_length > needle * 2 * patch.area())
      return divide_needle(start, end, apex, cells);
  }
  const int count = cells_along(std::sqrt(patch.area()), cell);
  const Vector3d u = patch.u / count, v = patch.v / count;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; i + j < count; ++j) {
      const Vector3d corner = patch.corner + i * u + j * v;
      cells.push_back({corner, u, v, false});
      if (i + j + 1 < count)
        cells.push_back({corner + u + v, -u, -v, false});
    }
  }
}

/// Returns the mean of 1/r over a cell, where r is the distance from a point.
double mean_inverse_distance(const Patch& cell, const Vector3d& point) {
  const Vector3d to_centre = cell.centre() - point;
  // Beyond this distance, relative to the cell's sides, the cell's extent changes the mean by less than one
  // part in a hundred.
  constexpr double far = 2.5;
  if (to_centre.norm() > far * (cell.u.norm() + cell.v.norm()))
    return 1 / to_centre.norm();
  const Vector3d a = cell.corner - point, b = a + cell.u, d = a + cell.v, c = b + cell.v;
  return cell.parallelogram ? kernel(a, b, c) + kernel(a, c, d) : 2 * kernel(a, b, d);
}

/// Computes the collocation matrix: the potentials, times 4π, at the centres of all cells of a unit charge on
/// each cell.
MatrixXd potentials(std::span<const Patch> cells) {
  const auto count = static_cast<Eigen::Index>(cells.size());
  MatrixXd result(count, count);
  for (Eigen::Index row = 0; row < count; ++row)
    for (Eigen::Index column = 0; column < count; ++column)
      result(row, column) = mean_inverse_distance(cells[static_cast<std::size_t>(column)],
                                                  cells[static_cast<std::size_t>(row)].centre());
  return result;
}

/// Neighbouring cells merged: a point charge with the self-potential of a square.
struct Group {
  Vector3d centre;
  double area;
};

/// Divides cells, given by their indices, into about `count` groups of neighbours.
void divide_in_groups(std::span<const Patch> cells, std::span<std::size_t> numbers, std::size_t count,
                      std::vector<Group>& groups) {
  if (count <= 1 || numbers.size() <= 1) {
    Group group{Vector3d::Zero(), 0};
    for (const std::size_t i : numbers) {
      group.area += cells[i].area();
      group.centre += cells[i].area() * cells[i].centre();
    }
    if (group.area > 0) {
      group.centre /= group.area;
      groups.push_back(group);
    }
    return;
  }
  const std::size_t half = numbers.size() / 2;
  split_at_median(numbers, half, [&](std::size_t i) { return cells[i].centre(); });
  divide_in_groups(cells, numbers.first(half), count / 2, groups);
  divide_in_groups(cells, numbers.subspan(half), count - count / 2, groups);
}

/// Computes the same matrix for groups of cells as point charges; their distances are limited from below.
MatrixXd potentials(std::span<const Group> groups) {
  const auto count = static_cast<Eigen::Index>(groups.size());
  MatrixXd result(count, count);
  for (Eigen::Index row = 0; row < count; ++row) {
    const Group& at = groups[static_cast<std::size_t>(row)];
    for (Eigen::Index column = 0; column < row; ++column)
      result(row, column) = result(column, row) =
          1 / std::max((groups[static_cast<std::size_t>(column)].centre - at.centre).norm(),
                       std::sqrt(at.area) / square_self_potential);
    result(row, row) = square_self_potential / std::sqrt(at.area);
  }
  return result;
}

/// Solves for the charges that make the potential 1 everywhere, and sets the own capacitance, their sum.
void settle(const MatrixXd& potentials_of_cells, ChargedSurface& surface) {
  const VectorXd one = VectorXd::Constant(potentials_of_cells.rows(), 1.0);
  const Eigen::PartialPivLU<MatrixXd> factors(potentials_of_cells);
  // Where surfaces coincide, any division of the charge between them is a solution; the one of least norm is
  // used.
  constexpr double least_condition = 1e-10;
  const VectorXd charges = factors.rcond() > least_condition
                               ? VectorXd(factors.solve(one))
                               : VectorXd(potentials_of_cells.completeOrthogonalDecomposition().solve(one));
  surface.own_capacitance = 4 * std::numbers::pi * charges.sum();
  surface.charges = charges / charges.sum();
}

/// Makes the linear and quadratic polynomials orthonormal with the charges as weights, by Gram–Schmidt, twice
/// because of rounding.
void make_modes(ChargedSurface& surface) {
  const VectorXd& weight = surface.charges;
  Matrix3Xd from_centre = surface.nodes.colwise() - surface.nodes * weight;
  const double size = std::sqrt((from_centre.array().square().matrix() * weight).maxCoeff());
  from_centre /= size;
  std::vector<VectorXd> candidates;
  candidates.reserve(9);
  for (int i = 0; i < 3; ++i)
    candidates.emplace_back(from_centre.row(i));
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      candidates.emplace_back(from_centre.row(i).cwiseProduct(from_centre.row(j)));
  std::vector<VectorXd> modes;
  const auto mean = [&weight](const VectorXd& values) { return weight.dot(values); };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    VectorXd values = candidates[i];
    for (int pass = 0; pass < 2; ++pass) {
      values.array() -= mean(values);
      for (const VectorXd& mode : modes)
        values -= mean(values.cwiseProduct(mode)) * mode;
    }
    // On a flat or regular surface some polynomials are combinations of others up to rounding.
    constexpr double negligible = 1e-6;
    const double squared = mean(values.cwiseAbs2());
    if (squared > negligible)
      modes.emplace_back(values / std::sqrt(squared));
    if (i == 2)
      surface.linear_modes = static_cast<Eigen::Index>(modes.size());
  }
  surface.modes.resize(static_cast<Eigen::Index>(modes.size()), weight.size());
  for (Eigen::Index i = 0; i < surface.modes.rows(); ++i)
    surface.modes.row(i) = modes[static_cast<std::size_t>(i)].cwiseProduct(weight);
}

/// Largest number of triangles in a cluster.
constexpr std::size_t cluster_size = 8;

/// Makes a cluster and, if the members lie in approximately one plane, the triangle that replaces them.
Cluster cluster_of(const ChargedSurface& surface, std::span<const std::size_t> members) {
  Cluster cluster;
  cluster.members.assign(members.begin(), members.end());
  Vector3d directed_area = Vector3d::Zero();
  for (const std::size_t i : members) {
    const auto& [a, b, c] = surface.triangles[i];
    cluster.centre += surface.areas[i] / 3 * (a + b + c);
    directed_area += surface.areas[i] * surface.normals[i];
    cluster.area += surface.areas[i];
  }
  // Below this ratio of the vector sum of the areas to their sum, the normals differ too much for one
  // triangle to represent the members.
  constexpr double least_common = 0.98;
  if (members.size() == 1 || !(directed_area.norm() > least_common * cluster.area)) {
    cluster.radius = std::numeric_limits<double>::infinity();
    return cluster;
  }
  cluster.centre /= cluster.area;
  for (const std::size_t i : members)
    for (const Vector3d& corner : surface.triangles[i])
      cluster.radius = std::max(cluster.radius, (corner - cluster.centre).norm());
  cluster.area = directed_area.norm();
  cluster.normal = directed_area / cluster.area;
  // For an equilateral triangle the area is 3√3/4 times the squared distance of a corner from the centre.
  const double reach = std::sqrt(4 * cluster.area / (3 * std::numbers::sqrt3));
  const Vector3d u = cluster.normal.unitOrthogonal(), v = cluster.normal.cross(u);
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / 3;
    cluster.stand_in[i] = cluster.centre + reach * (std::cos(angle) * u + std::sin(angle) * v);
  }
  return cluster;
}

/// Divides the triangles recursively at the median along the longest side of their bounding box until each
/// cluster is small enough.
void make_clusters(ChargedSurface& surface, std::span<std::size_t> indices) {
  if (indices.size() <= cluster_size) {
    surface.clusters.push_back(cluster_of(surface, indices));
    return;
  }
  const auto centre = [&surface](std::size_t i) -> Vector3d {
    const auto& [a, b, c] = surface.triangles[i];
    return a + b + c;
  };
  const std::size_t half = indices.size() / 2;
  split_at_median(indices, half, centre);
  make_clusters(surface, indices.first(half));
  make_clusters(surface, indices.subspan(half));
}

}  // namespace

std::vector<Triangle> plate_triangles(std::span<const Rectangle> plates) {
  std::vector<Triangle> triangles;
  for (const auto& [corner, u, v] : plates) {
    triangles.push_back({corner, corner + u, corner + u + v});
    triangles.push_back({corner, corner + u + v, corner + v});
  }
  return triangles;
}

bool has_area(const Triangle& triangle) {
  double reach = 0, longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    reach = std::max(reach, triangle[i].lpNorm<Eigen::Infinity>());
    longest = std::max(longest, (triangle[(i + 1) % 3] - triangle[i]).norm());
  }
  return twice_area(triangle) > 8 * std::numeric_limits<double>::epsilon() * reach * longest;
}

ChargedSurface make_charged_surface(std::vector<Triangle> triangles) {
  ChargedSurface surface;
  surface.closed = is_closed(triangles);
  surface.area = area(triangles);
  for (const Triangle& triangle : triangles) {
    const auto& [a, b, c] = triangle;
    surface.normals.push_back((b - a).cross(c - a).stableNormalized());
    surface.areas.push_back(twice_area(triangle) / 2);
  }
  std::vector<Patch> cells;
  const double cell = std::sqrt(surface.area / cells_per_surface);
  std::vector<Triangle> charged;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(charged), has_area);
  // Both triangles of a small sensor far from the origin may fail this test; they are used nevertheless,
  // since its edges are known independently of its corner.
  for (const Patch& patch : patches_of(charged.empty() ? triangles : charged))
    if (patch.area() > 0)
      divide(patch, cell, cells);
  surface.triangles = std::move(triangles);
  std::vector<std::size_t> indices(surface.triangles.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  make_clusters(surface, indices);
  const bool coarse = cells.size() <= most_nodes;
  std::vector<Group> groups;
  if (!coarse) {
    std::vector<std::size_t> numbers(cells.size());
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    divide_in_groups(cells, numbers, most_nodes, groups);
    settle(potentials(std::span<const Group>(groups)), surface);
  } else {
    for (const Patch& patch : cells)
      groups.push_back({patch.centre(), patch.area()});
    settle(potentials(std::span<const Patch>(cells)), surface);
    surface.own_capacitance /= coarseness;
  }
  surface.nodes.resize(3, static_cast<Eigen::Index>(groups.size()));
  for (std::size_t i = 0; i < groups.size(); ++i)
    surface.nodes.col(static_cast<Eigen::Index>(i)) = groups[i].centre;
  make_modes(surface);
  return surface;
}

}  // namespace fringe::detail
