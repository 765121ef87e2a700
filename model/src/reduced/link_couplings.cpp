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

/// Places the points of functions in their own frame.
void LinkCoupler::place(const ChargeFunctions& functions, const Isometry3d& to_other,
                        std::span<const AlignedBox3d> others) {
  levels_.clear();
  shares_.clear();
  points_.clear();
  for (std::size_t function = 0; function < functions.count(); ++function) {
    const std::size_t level = functions.level(function, to_other, others);
    levels_.push_back(level);
    const FunctionPoints& points = functions.points(level);
    const std::size_t first = points.first[function], end = points.first[function + 1];
    for (std::size_t k = first; k < end; ++k)
      points_.add(points.at[k], limit_of(functions, function, end - first));
    shares_.insert(shares_.end(), points.shares.begin() + index_of(first),
                   points.shares.begin() + index_of(end));
  }
  points_.fill_up();
  potentials_.resize(points_.limits.size());
}

/// Averages the potentials at the placed points over each of their functions.
void LinkCoupler::gather(const ChargeFunctions& functions, float* of_functions) const {
  std::size_t at = 0;
  for (std::size_t function = 0; function < functions.count(); ++function) {
    float sum = 0;
    for (const std::size_t end = at + functions.points(levels_[function]).count(function); at < end; ++at)
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
    const std::size_t level = rows.level(function, relative, columns.boxes());
    const FunctionPoints& points = rows.points(level);
    const std::size_t begin = points.first[function], count = points.first[function + 1] - begin;
    const float limit = limit_of(rows, function, count);
    of_row_.clear();
    for (std::size_t k = begin; k < begin + count; ++k)
      of_row_.add(moved * points.at[k], limit);
    const float* const shares = points.shares.data() + begin;
    if (level == finest)
      kernels.add_up_limited(of_row_.points(), shares, limit, points_.points(), points_.limits.data(),
                             potentials_.data());
    else
      kernels.add_up(of_row_.points(), shares, points_.points(), potentials_.data());
    gather(columns, functions.col(static_cast<Index>(function)).data());
  }
}

void LinkCoupler::find_forces(const ChargeFunctions& on, const ChargeFunctions& of,
                              const Isometry3d& relative, const Eigen::MatrixXf& charges, Forces& forces) {
  place(of, relative.inverse(Eigen::Isometry), on.boxes());
  const auto fields = static_cast<std::size_t>(charges.cols());
  std::vector<float>& of_points = forces_.start(points_, fields);
  std::size_t point = 0;
  for (std::size_t function = 0; function < of.count(); ++function)
    for (const std::size_t end = point + of.points(levels_[function]).count(function); point < end; ++point)
      for (std::size_t field = 0; field < fields; ++field)
        of_points[point * fields + field] = shares_[point] * charges(index_of(function), index_of(field));
  forces.setZero(6 * index_of(on.count()), charges.cols());
  on.visit_points(
      relative, [&](std::size_t function) { return on.level(function, relative, of.boxes()); },
      [&](const Vector3d& at, std::size_t function, const FunctionPoints& points, std::size_t k) {
        const float limit = &points == &on.points(finest) ? limit_of(on, function, points.count(function))
                                                          : std::numeric_limits<float>::infinity();
        forces_.add({at.cast<float>(), index_of(function), points.shares[k], limit}, forces);
      });
  forces_.finish(forces);
}

void LimitedPoints::clear() {
  for (std::vector<float>* values : {&x, &y, &z, &limits})
    values->clear();
  count = 0;
}

void LimitedPoints::add(const Eigen::Vector3f& at, float limit) {
  x.push_back(at.x()), y.push_back(at.y()), z.push_back(at.z());
  limits.push_back(limit);
  ++count;
}

void LimitedPoints::fill_up() {
  const auto padded = static_cast<std::size_t>(whole_blocks(index_of(count)));
  for (std::vector<float>* coordinates : {&x, &y, &z})
    coordinates->resize(padded, padded_coordinate);
  limits.resize(padded, 1.0F);
}

std::vector<float>& PointForces::start(const LimitedPoints& sources, std::size_t fields) {
  sources_ = &sources;
  fields_count_ = fields;
  points_.clear();
  charges_.assign(sources.count * fields, 0.0F);
  return charges_;
}

void PointForces::add(const Point& point, Forces& forces) {
  points_.push_back(point);
  if (points_.size() == static_cast<std::size_t>(node_block))
    finish(forces);
}

/// Adds the forces on the points of a block, and forgets these.
void PointForces::finish(Forces& forces) {
  if (points_.empty())
    return;
  /// Number of sources that are evaluated together: their arrays stay in the nearest cache.
  constexpr std::size_t together = 128;
  constexpr auto in_block = static_cast<std::size_t>(node_block);
  const std::size_t fields = fields_count_;
  const auto& kernels = best_kernels<NodeKernels>();
  std::array<std::array<float, in_block>, 3> at{};
  std::array<float, in_block> limits{};
  bool is_any_limited = false;
  for (std::size_t p = 0; p < in_block; ++p) {
    const Point& point = points_[std::min(p, points_.size() - 1)];
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
  const std::array<const std::vector<float>*, 3> sources{&sources_->x, &sources_->y, &sources_->z};
  for (std::size_t begin = 0; begin < sources_->count; begin += together) {
    const std::size_t count = std::min(together, sources_->count - begin);
    kernels.fill(
        {sources_->x.data() + begin, sources_->y.data() + begin, sources_->z.data() + begin, index_of(count)},
        {at[0].data(), at[1].data(), at[2].data(), node_block}, inverse_distances_.data());
    for (std::size_t k = 0; k < count; ++k) {
      float* const values = inverse_distances_.data() + k * in_block;
      if (is_any_limited) {
        // At the same place 1/r is not a number, which is not less than the limit.
        const float limit = sources_->limits[begin + k];
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
                      {charges_.data() + begin * fields, index_of(fields), index_of(fields)}, sums_.data());
      kernels.add(1, sums_.data(), fields_.data() + axis * fields * in_block, index_of(sums_.size()));
    }
  }
  for (std::size_t field = 0; field < fields; ++field)
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const Point& point = points_[p];
      const auto component = [&](std::size_t axis) {
        return static_cast<double>(fields_[(axis * fields + field) * in_block + p]);
      };
      const Vector3d force = point.share * Vector3d(component(0), component(1), component(2));
      auto sum = forces.col(index_of(field)).segment<6>(6 * point.function);
      sum.head<3>() += force;
      sum.tail<3>() += point.at.cast<double>().cross(force);
    }
  points_.clear();
}

}  // namespace fringe::detail
