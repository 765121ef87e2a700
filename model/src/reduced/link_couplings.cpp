#include "reduced/link_couplings.hpp"

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
  return functions.level(function, std::sqrt(nearest));
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

void LinkCoupler::couple(const ChargeFunctions& rows, const ChargeFunctions& columns,
                         const Isometry3d& relative, Eigen::MatrixXf& functions) {
  const auto& kernels = best_kernels<NodeKernels>();
  place(columns, relative.inverse(Eigen::Isometry), rows.boxes());
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
    const NodePoints points_of_row{row_x_.data(), row_y_.data(), row_z_.data(), index_of(count)},
        points_of_columns{x_.data(), y_.data(), z_.data(), index_of(count_)};
    const float* const shares = points.shares.data() + begin;
    if (level == finest)
      kernels.add_up_limited(points_of_row, shares, limit_of(rows, function, count), points_of_columns,
                             limits_.data(), potentials_.data());
    else
      kernels.add_up(points_of_row, shares, points_of_columns, potentials_.data());
    gather(columns, functions.col(static_cast<Index>(function)).data());
  }
}

void LinkCoupler::find_forces(const ChargeFunctions& on, const ChargeFunctions& of,
                              const Isometry3d& relative, const Eigen::MatrixXf& charges, Forces& forces) {
  constexpr auto in_block = static_cast<std::size_t>(node_block);
  place(of, relative.inverse(Eigen::Isometry), on.boxes());
  const auto fields = static_cast<std::size_t>(charges.cols());
  field_charges_.resize(count_ * fields);
  std::size_t point = 0;
  for (std::size_t function = 0; function < of.count(); ++function) {
    const FunctionPoints& points = of.points(levels_[function]);
    for (const std::size_t end = point + points.first[function + 1] - points.first[function]; point < end;
         ++point)
      for (std::size_t field = 0; field < fields; ++field)
        field_charges_[point * fields + field] =
            shares_[point] * charges(index_of(function), index_of(field));
  }
  forces.setZero(6 * index_of(on.count()), charges.cols());
  force_points_.clear();
  const Eigen::Isometry3f moved = relative.cast<float>();
  for (std::size_t function = 0; function < on.count(); ++function) {
    const std::size_t level = level_beside(on, function, relative, of.boxes());
    const FunctionPoints& points = on.points(level);
    const std::size_t begin = points.first[function], end = points.first[function + 1];
    const float limit =
        level == finest ? limit_of(on, function, end - begin) : std::numeric_limits<float>::infinity();
    for (std::size_t k = begin; k < end; ++k) {
      force_points_.push_back({moved * points.at[k], index_of(function), points.shares[k], limit});
      if (force_points_.size() == in_block)
        add_fields(fields, forces);
    }
  }
  if (!force_points_.empty())
    add_fields(fields, forces);
}

/// Adds the forces on the points of a block, and forgets these.
void LinkCoupler::add_fields(std::size_t fields, Forces& forces) {
  /// Number of sources that are evaluated together: their arrays stay in the nearest cache.
  constexpr std::size_t together = 128;
  constexpr auto in_block = static_cast<std::size_t>(node_block);
  const auto& kernels = best_kernels<NodeKernels>();
  std::array<std::array<float, in_block>, 3> at{};
  std::array<float, in_block> limits{};
  bool is_any_limited = false;
  for (std::size_t p = 0; p < in_block; ++p) {
    const ForcePoint& point = force_points_[std::min(p, force_points_.size() - 1)];
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis][p] = point.at[static_cast<Index>(axis)];
    limits[p] = point.limit;
    is_any_limited = is_any_limited || std::isfinite(point.limit);
  }
  inverse_distances_.resize(std::max(inverse_distances_.size(), together * in_block));
  for (std::vector<float>& component : gradients_)
    component.resize(together * in_block);
  sums_.resize(fields * in_block);
  fields_.assign(3 * fields * in_block, 0.0F);
  const std::array<const std::vector<float>*, 3> sources{&x_, &y_, &z_};
  for (std::size_t begin = 0; begin < count_; begin += together) {
    const std::size_t count = std::min(together, count_ - begin);
    kernels.fill({x_.data() + begin, y_.data() + begin, z_.data() + begin, index_of(count)},
                 {at[0].data(), at[1].data(), at[2].data(), node_block}, inverse_distances_.data());
    for (std::size_t k = 0; k < count; ++k) {
      float* const values = inverse_distances_.data() + k * in_block;
      if (is_any_limited) {
        // At the same place 1/r is not a number, which is not less than the limit.
        const float limit = limits_[begin + k];
        for (std::size_t p = 0; p < in_block; ++p)
          values[p] =
              values[p] < limits[p] && (values[p] < limit || !std::isfinite(limits[p])) ? values[p] : 0;
      }
      for (std::size_t p = 0; p < in_block; ++p)
        values[p] *= values[p] * values[p];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float source = (*sources[axis])[begin + k];
        float* const gradient = gradients_[axis].data() + k * in_block;
        for (std::size_t p = 0; p < in_block; ++p)
          gradient[p] = (source - at[axis][p]) * values[p];
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      kernels.combine({gradients_[axis].data(), index_of(count)},
                      {field_charges_.data() + begin * fields, index_of(fields), index_of(fields)},
                      sums_.data());
      kernels.add(1, sums_.data(), fields_.data() + axis * fields * in_block, index_of(sums_.size()));
    }
  }
  for (std::size_t field = 0; field < fields; ++field)
    for (std::size_t p = 0; p < force_points_.size(); ++p) {
      const ForcePoint& point = force_points_[p];
      const auto component = [&](std::size_t axis) {
        return static_cast<double>(fields_[(axis * fields + field) * in_block + p]);
      };
      const Vector3d force = point.share * Vector3d(component(0), component(1), component(2));
      auto sum = forces.col(index_of(field)).segment<6>(6 * point.function);
      sum.head<3>() += force;
      sum.tail<3>() += point.at.cast<double>().cross(force);
    }
  force_points_.clear();
}

}  // namespace fringe::detail
