#include "reduced/potential_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "reduced/node_kernels.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Largest number of halvings of the largest cells.
constexpr unsigned most_cell_levels = 8;

/// Largest number of cells: 32 KiB each with 128 values at a node.
constexpr std::size_t most_cells = 8000;

/// Least distance of a cell from the machine, over its side.
constexpr double least_clearance = 0.75;

/// Entries of places_ that are no cells.
constexpr std::int64_t divided_cell = -1, no_cell = -2;

/// Bits of a cell's number along an axis.
constexpr unsigned axis_bits = 20;

constexpr std::size_t per_side = PotentialTable::nodes_per_side;

/// Tells whether the cell around a point has a number of its own along every axis.
bool is_numbered(const Vector3d& point, double side) {
  return (point / side).cwiseAbs().maxCoeff() < static_cast<double>(std::int64_t{1} << (axis_bits - 1));
}

/// Returns Chebyshev's polynomials of degree 1 and more.
std::array<double, per_side - 1> chebyshev_polynomials(double at) {
  std::array<double, per_side - 1> values{};
  double before = 1, value = at;
  for (double& entry : values) {
    entry = value;
    const double next = 2 * at * value - before;
    before = value;
    value = next;
  }
  return values;
}

double chebyshev_node(std::size_t index) {
  return std::cos((2 * static_cast<double>(index) + 1) * std::numbers::pi / (2 * per_side));
}

/// Returns the derivatives of Chebyshev's polynomials of degree 1 and more.
std::array<double, per_side - 1> chebyshev_derivatives(double at) {
  const std::array<double, per_side - 1> values = chebyshev_polynomials(at);
  std::array<double, per_side - 1> derivatives{};
  double before = 0, derivative = 1;
  for (std::size_t k = 0; k < derivatives.size(); ++k) {
    derivatives[k] = derivative;
    const double next = 2 * values[k] + 2 * at * derivative - before;
    before = derivative;
    derivative = next;
  }
  return derivatives;
}

/// Returns Chebyshev's polynomials, those of degree 1 and more, at the nodes.
const std::array<std::array<double, per_side - 1>, per_side>& chebyshev_at_nodes() {
  static const std::array<std::array<double, per_side - 1>, per_side> at_nodes = [] {
    std::array<std::array<double, per_side - 1>, per_side> values{};
    for (std::size_t k = 0; k < per_side; ++k)
      values[k] = chebyshev_polynomials(chebyshev_node(k));
    return values;
  }();
  return at_nodes;
}

/// Returns the sums of Chebyshev's polynomials, or of their derivatives, that make Lagrange's of the nodes.
std::array<float, per_side> lagrange(double constant, const std::array<double, per_side - 1>& polynomials) {
  const auto& at_nodes = chebyshev_at_nodes();
  std::array<float, per_side> result{};
  for (std::size_t k = 0; k < per_side; ++k) {
    double sum = constant;
    for (std::size_t degree = 0; degree < polynomials.size(); ++degree)
      sum += at_nodes[k][degree] * polynomials[degree];
    result[k] = static_cast<float>(2 * sum / per_side);
  }
  return result;
}

/// Returns the values of Lagrange's polynomials of the nodes.
std::array<float, per_side> lagrange_values(double at) {
  return lagrange(0.5, chebyshev_polynomials(at));
}

/// Returns the derivatives of Lagrange's polynomials of the nodes.
std::array<float, per_side> lagrange_derivatives(double at) {
  return lagrange(0, chebyshev_derivatives(at));
}

}  // namespace

PotentialTable::PotentialTable(const OutsidePotentials& potentials, double largest)
    : potentials_(potentials), largest_(largest) {}

std::uint64_t PotentialTable::key(const Vector3d& point, unsigned level, double side) {
  std::uint64_t result = level;
  for (Index axis = 0; axis < 3; ++axis) {
    const auto number = static_cast<std::int64_t>(std::floor(point[axis] / side));
    result =
        result << axis_bits | (static_cast<std::uint64_t>(number) & ((std::uint64_t{1} << axis_bits) - 1));
  }
  return result;
}

bool PotentialTable::add(const Vector3d& point) {
  double side = largest_;
  for (unsigned level = 0; level <= most_cell_levels && is_numbered(point, side); ++level, side /= 2) {
    const auto [entry, is_new] = places_.try_emplace(key(point, level, side), divided_cell);
    if (is_new) {
      const Vector3d centre = side * ((point / side).array().floor() + 0.5);
      const double clearance = potentials_.clearance(centre) - std::sqrt(3.0) / 2 * side;
      if (clearance >= least_clearance * side && cells_.size() < most_cells) {
        entry->second = static_cast<std::int64_t>(cells_.size());
        cells_.push_back({centre, side / 2});
      } else if (cells_.size() >= most_cells) {
        entry->second = no_cell;
        return false;
      } else if (level == most_cell_levels) {
        entry->second = no_cell;
      }
    }
    if (entry->second != divided_cell)
      return true;
  }
  return true;
}

void PotentialTable::clear() {
  places_.clear();
  cells_.clear();
  values_.clear();
}

/// Makes the places of cells that are known.
void PotentialTable::number_cells() {
  places_.clear();
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    double side = largest_;
    unsigned level = 0;
    for (; side > 3 * cells_[cell].half; ++level, side /= 2)
      places_.try_emplace(key(cells_[cell].centre, level, side), divided_cell);
    places_[key(cells_[cell].centre, level, side)] = static_cast<std::int64_t>(cell);
  }
}

std::vector<Vector3d> PotentialTable::centres() const {
  std::vector<Vector3d> result;
  result.reserve(cells_.size());
  for (const Cell& cell : cells_)
    result.push_back(cell.centre);
  return result;
}

void PotentialTable::fill(const Eigen::MatrixXf& charges, std::size_t threads) {
  // Fields in the table need their width also where there is no cell.
  const Index given = potentials_.given();
  width_ = static_cast<std::size_t>(whole_blocks(given + charges.cols()));
  const std::size_t filled = width_ > 0 ? values_.size() / (nodes * width_) : 0;
  if (filled == cells_.size() || width_ == 0)
    return;
  std::vector<Vector3d> points;
  points.reserve((cells_.size() - filled) * nodes);
  for (const Cell& cell : std::span(cells_).subspan(filled))
    for (std::size_t k = 0; k < nodes; ++k)
      points.emplace_back(cell.centre + cell.half * Vector3d(chebyshev_node(k % per_side),
                                                             chebyshev_node(k / per_side % per_side),
                                                             chebyshev_node(k / (per_side * per_side))));
  const OutsidePotentials::Values values = potentials_.at(points, charges.cols() > 0, &charges, threads);
  values_.resize(cells_.size() * nodes * width_, 0.0F);
  Eigen::Map<TrianglePotentials> rows(values_.data() + filled * nodes * width_, values.of_given.rows(),
                                      static_cast<Index>(width_));
  rows.leftCols(given) = values.of_given;
  rows.middleCols(given, charges.cols()) = values.of_functions;
}

std::optional<std::size_t> PotentialTable::find(const Vector3d& point) const {
  double side = largest_;
  for (unsigned level = 0; level <= most_cell_levels && is_numbered(point, side); ++level, side /= 2) {
    const auto entry = places_.find(key(point, level, side));
    if (entry == places_.end() || entry->second == no_cell)
      return std::nullopt;
    if (entry->second >= 0)
      return static_cast<std::size_t>(entry->second);
  }
  return std::nullopt;
}

bool PotentialTable::contains(std::size_t cell, const Vector3d& point) const {
  return (point - cells_[cell].centre).cwiseAbs().maxCoeff() <= cells_[cell].half;
}

void PotentialTable::add_weights(std::size_t cell, const Vector3d& point, float factor,
                                 std::array<float, nodes>& weights) const {
  const Vector3d at = (point - cells_[cell].centre) / cells_[cell].half;
  const std::array<float, per_side> x = lagrange_values(at.x()), y = lagrange_values(at.y()),
                                    z = lagrange_values(at.z());
  std::size_t k = 0;
  for (std::size_t c = 0; c < per_side; ++c)
    for (std::size_t b = 0; b < per_side; ++b) {
      const float across = factor * z[c] * y[b];
      for (std::size_t a = 0; a < per_side; ++a)
        weights[k++] += across * x[a];
    }
}

void PotentialTable::add_wrench_weights(std::size_t cell, const Vector3d& point, float factor,
                                        WrenchWeights& weights) const {
  const Vector3d at = (point - cells_[cell].centre) / cells_[cell].half;
  const std::array<float, per_side> x = lagrange_values(at.x()), y = lagrange_values(at.y()),
                                    z = lagrange_values(at.z()), dx = lagrange_derivatives(at.x()),
                                    dy = lagrange_derivatives(at.y()), dz = lagrange_derivatives(at.z());
  // Coordinates are in halves of the side, by which the gradient is divided and its moment is not.
  const float scale = factor / static_cast<float>(cells_[cell].half);
  const Eigen::Vector3f arm = factor * at.cast<float>();
  std::size_t k = 0;
  for (std::size_t c = 0; c < per_side; ++c)
    for (std::size_t b = 0; b < per_side; ++b) {
      const float by_x = y[b] * z[c], by_y = dy[b] * z[c], by_z = y[b] * dz[c];
      for (std::size_t a = 0; a < per_side; ++a, ++k) {
        const float gx = dx[a] * by_x, gy = x[a] * by_y, gz = x[a] * by_z;
        weights[0][k] += scale * gx;
        weights[1][k] += scale * gy;
        weights[2][k] += scale * gz;
        weights[3][k] += arm.y() * gz - arm.z() * gy;
        weights[4][k] += arm.z() * gx - arm.x() * gz;
        weights[5][k] += arm.x() * gy - arm.y() * gx;
      }
    }
}

double PotentialTable::least_side() const {
  return std::ldexp(largest_, -static_cast<int>(most_cell_levels));
}

}  // namespace fringe::detail
