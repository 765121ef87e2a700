#include "correction/link_couplings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Mean of 1/r over pairs of points of a square of side 1: (4/3)(1 + 3 asinh 1 − √2).
constexpr double potential_of_square = 2.9732;

/// The level whose points may be closer to the other group than their parts of the surface are large.
constexpr std::size_t finest = ChargeFunctions::points_per_function.size() - 1;

/// Returns the largest potential of a point of a function, for its part of the surface a square: of a
/// function's surface, about a square in a sphere of its radius.
float limit_of(const ChargeFunctions& functions, std::size_t function, std::size_t points) {
  return static_cast<float>(potential_of_square * std::sqrt(static_cast<double>(points) / 2) /
                            functions.radius(function));
}

}  // namespace

std::size_t level_beside(const ChargeFunctions& functions, std::size_t function, const Isometry3d& to_other,
                         std::span<const AlignedBox3d> others) {
  const Vector3d centre = to_other * functions.centre(function);
  double nearest = std::numeric_limits<double>::infinity();
  for (const AlignedBox3d& box : others)
    nearest = std::min(nearest, box.squaredExteriorDistance(centre));
  return functions.level(function, std::sqrt(nearest), true);
}

bool keep_relative_pose(const Isometry3d& a, const Isometry3d& b) {
  constexpr double rounding = 1e-12;
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() <=
         rounding * (1 + b.translation().cwiseAbs().maxCoeff());
}

/// Places the points of functions in their own frame.
void LinkCoupler::place(const ChargeFunctions& functions, const Isometry3d& to_other,
                        std::span<const AlignedBox3d> others) {
  levels_.clear();
  for (std::vector<float>* values : {&x_, &y_, &z_, &shares_, &limits_})
    values->clear();
  for (std::size_t function = 0; function < functions.count(); ++function) {
    const std::size_t level = level_beside(functions, function, to_other, others);
    levels_.push_back(level);
    const FunctionPoints& points = functions.points(level);
    const std::size_t first = points.first[function], end = points.first[function + 1];
    limits_.insert(limits_.end(), end - first, limit_of(functions, function, end - first));
    for (std::size_t k = first; k < end; ++k) {
      x_.push_back(points.at[k].x()), y_.push_back(points.at[k].y()), z_.push_back(points.at[k].z());
      shares_.push_back(points.shares[k]);
    }
  }
  count_ = x_.size();
  const auto padded = static_cast<std::size_t>(whole_blocks(static_cast<std::ptrdiff_t>(count_)));
  for (std::vector<float>* coordinates : {&x_, &y_, &z_})
    coordinates->resize(padded, padded_coordinate);
  limits_.resize(padded, 1.0F);
  potentials_.resize(padded);
}

/// Averages the potentials at the placed points over each of their functions.
void LinkCoupler::gather(const ChargeFunctions& functions, float* of_functions) const {
  std::size_t at = 0;
  for (std::size_t function = 0; function < functions.count(); ++function) {
    const FunctionPoints& points = functions.points(levels_[function]);
    float sum = 0;
    for (const std::size_t end = at + points.first[function + 1] - points.first[function]; at < end; ++at)
      sum += shares_[at] * potentials_[at];
    of_functions[function] = sum;
  }
}

/// Limits the potentials between points that are closer than their parts of the surface are large.
void LinkCoupler::limit(float row_limit, std::size_t rows) {
  const std::size_t padded = potentials_.size();
  for (std::size_t row = 0; row < rows; ++row) {
    float* values = inverse_distances_.data() + row * padded;
    for (std::size_t k = 0; k < padded; ++k)
      // At the same place the potential is not a number, which is not less than the limit.
      values[k] = std::min(std::min(row_limit, limits_[k]), values[k]);
  }
}

void LinkCoupler::couple(const ChargeFunctions& rows, const ChargeFunctions& columns,
                         const Isometry3d& relative, Eigen::MatrixXf& functions) {
  const auto& kernels = best_kernels<NodeKernels>();
  place(columns, relative.inverse(Eigen::Isometry), rows.boxes());
  const auto padded = static_cast<std::ptrdiff_t>(potentials_.size());
  functions.resize(static_cast<Index>(columns.count()), static_cast<Index>(rows.count()));
  const Eigen::Isometry3f moved = relative.cast<float>();
  for (std::size_t function = 0; function < rows.count(); ++function) {
    const std::size_t level = level_beside(rows, function, relative, columns.boxes());
    const FunctionPoints& points = rows.points(level);
    const std::size_t begin = points.first[function], count = points.first[function + 1] - begin;
    row_x_.clear(), row_y_.clear(), row_z_.clear();
    for (std::size_t k = begin; k < begin + count; ++k) {
      const Eigen::Vector3f at = moved * points.at[k];
      row_x_.push_back(at.x()), row_y_.push_back(at.y()), row_z_.push_back(at.z());
    }
    if (inverse_distances_.size() < count * potentials_.size())
      inverse_distances_.resize(count * potentials_.size());
    kernels.fill({row_x_.data(), row_y_.data(), row_z_.data(), static_cast<std::ptrdiff_t>(count)},
                 {x_.data(), y_.data(), z_.data(), static_cast<std::ptrdiff_t>(count_)},
                 inverse_distances_.data());
    if (level == finest)
      limit(limit_of(rows, function, count), count);
    std::fill(potentials_.begin(), potentials_.end(), 0.0F);
    for (std::size_t k = 0; k < count; ++k)
      kernels.add(points.shares[begin + k],
                  inverse_distances_.data() + static_cast<std::ptrdiff_t>(k) * padded, potentials_.data(),
                  padded);
    gather(columns, functions.col(static_cast<Index>(function)).data());
  }
}

}  // namespace fringe::detail
