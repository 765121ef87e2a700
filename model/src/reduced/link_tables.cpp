#include "reduced/link_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "reduced/link_couplings.hpp"
#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXf;
using Eigen::Vector3d;

using TableRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Side of the largest cells over the diagonal of the box around the targets.
constexpr double largest_link_cell = 1;

/// The level of the link's points for places that are in no cell.
constexpr std::size_t level_of_near = 2;

/// The level of the others' points where these are in no cell.
constexpr std::size_t level_at_near = 1;

/// Largest potential of one of n points of a function, times the function's radius over √n: about that in the
/// middle of its part of the surface.
constexpr double most_of_part = 2;

double side_of_largest_cells(const TargetAtRest& target) {
  Eigen::AlignedBox3d box;
  for (const Eigen::AlignedBox3d& each : target.functions().boxes())
    box.extend(each);
  return largest_link_cell * box.diagonal().norm();
}

/// Calls a function with every point of functions beside a link, the number of its function, and its place
/// among the points of a level. Functions whose centres are in no cell of the table have a few points.
template <typename Visit>
void visit_points_beside(const ChargeFunctions& functions, const Isometry3d& pose,
                         const ChargeFunctions& of_link, const PotentialTable& table,
                         std::size_t coarsest_level, const Visit& visit) {
  for (std::size_t function = 0; function < functions.count(); ++function) {
    std::size_t level = std::max(level_beside(functions, function, pose, of_link.boxes()), coarsest_level);
    if (level > level_at_near && !table.find(pose * functions.centre(function)))
      level = level_at_near;
    const FunctionPoints& points = functions.points(level);
    for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k)
      visit(pose * points.at[k].cast<double>(), function, points, k);
  }
}

/// Returns the largest potential of a point of a link's function.
double limit_of_part(const ChargeFunctions& link, std::size_t function) {
  const FunctionPoints& points = link.points(level_of_near);
  const std::size_t count = points.first[function + 1] - points.first[function];
  return most_of_part * std::sqrt(static_cast<double>(count)) / link.radius(function);
}

}  // namespace

LinkTable::LinkTable(const ChargeFunctions& functions, double largest)
    : functions_(functions), potentials_(functions), table_(potentials_, largest) {
  const FunctionPoints& points = functions.points(level_of_near);
  const Index count = index_of(points.at.size());
  const auto padded = static_cast<std::size_t>(whole_blocks(count));
  for (std::vector<float>* coordinates : {&near_x_, &near_y_, &near_z_})
    coordinates->assign(padded, padded_coordinate);
  near_limits_.assign(padded, 1.0F);
  near_charges_.setZero(index_of(padded), points.given.cols());
  near_charges_.topRows(count) = points.given;
  for (std::size_t k = 0; k < points.at.size(); ++k)
    near_x_[k] = points.at[k].x(), near_y_[k] = points.at[k].y(), near_z_[k] = points.at[k].z();
  for (std::size_t function = 0; function < functions.count(); ++function)
    std::fill(near_limits_.begin() + static_cast<std::ptrdiff_t>(points.first[function]),
              near_limits_.begin() + static_cast<std::ptrdiff_t>(points.first[function + 1]),
              static_cast<float>(limit_of_part(functions, function)));
}

/// Adds the potentials of the given charges at points close to the link to the rows that these are shares
/// of. Charges are points, too.
void LinkTable::add_near(NearPoints& workspace, MatrixXf& given) const {
  /// Number of charges that are evaluated together: their distances stay in the nearest cache.
  constexpr std::size_t together = 128;
  constexpr auto in_block = static_cast<std::size_t>(node_block);
  const auto& kernels = best_kernels<NodeKernels>();
  const std::vector<NearPoints::Share>& shares = workspace.shares;
  const Index loads = given.cols();
  const auto size = static_cast<std::size_t>(loads) * in_block;
  workspace.potentials.resize(together * in_block);
  workspace.of_chunk.resize(size);
  std::array<std::array<float, in_block>, 3> at{};
  for (std::size_t first = 0; first < shares.size(); first += in_block) {
    for (std::size_t p = 0; p < in_block; ++p)
      for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis][p] = static_cast<float>(shares[std::min(first + p, shares.size() - 1)].at[index_of(axis)]);
    workspace.of_loads.assign(size, 0.0F);
    for (std::size_t begin = 0; begin < near_limits_.size(); begin += together) {
      const std::size_t count = std::min(together, near_limits_.size() - begin);
      float* const values = workspace.potentials.data();
      kernels.fill({near_x_.data() + begin, near_y_.data() + begin, near_z_.data() + begin, index_of(count)},
                   {at[0].data(), at[1].data(), at[2].data(), node_block}, values);
      for (std::size_t k = 0; k < count; ++k) {
        // At the same place 1/r is not a number, which is not less than the limit.
        const float limit = near_limits_[begin + k];
        for (std::size_t p = k * in_block; p < (k + 1) * in_block; ++p)
          values[p] = values[p] < limit ? values[p] : limit;
      }
      kernels.combine({values, index_of(count)}, {near_charges_.row(index_of(begin)).data(), loads, loads},
                      workspace.of_chunk.data());
      kernels.add(1, workspace.of_chunk.data(), workspace.of_loads.data(), index_of(size));
    }
    for (std::size_t p = 0; p < std::min(in_block, shares.size() - first); ++p)
      for (Index load = 0; load < loads; ++load)
        given(shares[first + p].row, load) +=
            shares[first + p].share * workspace.of_loads[static_cast<std::size_t>(load) * in_block + p];
  }
}

/// Adds the forces on a share of a function's charge close to the link: the derivatives of what add_near()
/// finds.
void LinkTable::add_near_force(const Vector3d& place, std::size_t function, float share,
                               const std::vector<Index>& carried, Forces& forces) const {
  for (std::size_t k = 0; k < near_limits_.size(); ++k) {
    const Vector3d towards = Eigen::Vector3f(near_x_[k], near_y_[k], near_z_[k]).cast<double>() - place;
    const double inverse_distance = 1 / towards.norm();
    // Below the limit the potential is constant.
    if (!(inverse_distance < near_limits_[k]))
      continue;
    const Vector3d gradient = share * std::pow(inverse_distance, 3) * towards, moment = place.cross(gradient);
    for (std::size_t load = 0; load < carried.size(); ++load) {
      const double charge = near_charges_(index_of(k), index_of(load));
      auto force = forces.col(carried[load]).segment<6>(6 * index_of(function));
      force.head<3>() += charge * gradient;
      force.tail<3>() += charge * moment;
    }
  }
}

bool LinkTable::add(const ChargeFunctions& others, const Isometry3d& pose) {
  bool have_cells = true;
  const auto add_point = [&](const Vector3d& at) { have_cells = table_.add(at) && have_cells; };
  for (std::size_t function = 0; function < others.count(); ++function)
    add_point(pose * others.centre(function));
  visit_points_beside(
      others, pose, functions_, table_, 0,
      [&](const Vector3d& at, std::size_t, const FunctionPoints&, std::size_t) { add_point(at); });
  return have_cells;
}

void LinkTable::fill(std::size_t threads) {
  table_.fill(MatrixXf(static_cast<Index>(functions_.count()), 0), threads);
}

void LinkTable::write(const ChargeFunctions& others, const Isometry3d& pose, MatrixXf& given,
                      NearPoints& workspace) const {
  const Index count = functions_.panels().given.cols(), functions = index_of(others.count()),
              carried = others.panels().given.cols() / 2;
  given.setZero(functions + carried, count);
  if (count == 0)
    return;
  std::array<float, PotentialTable::nodes> weights{};
  std::optional<std::size_t> cell;
  Index current = 0;
  const auto finish = [&] {
    if (!cell)
      return;
    const Eigen::Map<const TableRows, 0, Eigen::OuterStride<>> values(
        table_.values(*cell), PotentialTable::nodes, count,
        Eigen::OuterStride<>(static_cast<Index>(table_.width())));
    given.row(current).noalias() +=
        Eigen::Map<const Eigen::RowVectorXf>(weights.data(), PotentialTable::nodes) * values;
    weights.fill(0);
    cell.reset();
  };
  workspace.shares.clear();
  const auto add = [&](const Vector3d& at, Index row, float charge) {
    if (row != current || !cell || !table_.contains(*cell, at)) {
      finish();
      current = row;
      cell = table_.find(at);
    }
    if (cell)
      table_.add_weights(*cell, at, charge, weights);
    else
      workspace.shares.push_back({at, row, charge});
  };
  visit_points_beside(others, pose, functions_, table_, 0,
                      [&](const Vector3d& at, std::size_t function, const FunctionPoints& points,
                          std::size_t k) { add(at, index_of(function), points.shares[k]); });
  for (Index load = 0; load < carried; ++load)
    visit_points_beside(others, pose, functions_, table_, ChargeFunctions::first_with_moments,
                        [&](const Vector3d& at, std::size_t, const FunctionPoints& points, std::size_t k) {
                          add(at, functions + load, points.given(index_of(k), load));
                        });
  finish();
  add_near(workspace, given);
}

void LinkTable::find_forces(const ChargeFunctions& others, const Isometry3d& pose, Index loads,
                            const std::vector<Index>& carried, TableForces& workspace, Forces& forces) const {
  forces.setZero(6 * index_of(others.count()), loads);
  if (carried.empty())
    return;
  MatrixXf factors = MatrixXf::Zero(index_of(table_.width()), loads);
  for (std::size_t load = 0; load < carried.size(); ++load)
    factors(index_of(load), carried[load]) = 1;
  workspace.start(table_, factors);
  visit_points_beside(
      others, pose, functions_, table_, 0,
      [&](const Vector3d& at, std::size_t function, const FunctionPoints& points, std::size_t k) {
        if (!workspace.add(at, function, points.shares[k], forces))
          add_near_force(at, function, points.shares[k], carried, forces);
      });
  workspace.finish(forces);
}

LinkTables::LinkTables(const LinkedMachine& machine, const TargetAtRest& target) {
  const double largest = side_of_largest_cells(target);
  for (const MachineLink& link : machine.links())
    tables_.emplace_back(link.functions(), largest);
}

void LinkTables::extend(const LinkedMachine& machine, const TargetAtRest& target,
                        std::span<const PoseOfMachine> poses, std::size_t threads) {
  const auto add = [&](std::size_t link) {
    bool have_cells = true;
    before_.assign(tables_.size(), std::nullopt);
    for (const PoseOfMachine& pose : poses) {
      const Isometry3d to_link = pose.links[link].inverse(Eigen::Isometry);
      have_cells = tables_[link].add(target.functions(), to_link * pose.target) && have_cells;
      for (std::size_t other = 0; other < before_.size(); ++other) {
        const Isometry3d relative = to_link * pose.links[other];
        if (other == link || (before_[other] && keep_relative_pose(*before_[other], relative)))
          continue;
        have_cells = tables_[link].add(machine.links()[other].functions(), relative) && have_cells;
        before_[other] = relative;
      }
    }
    return have_cells;
  };
  for (std::size_t link = 0; link < tables_.size(); ++link) {
    if (machine.links()[link].loads().empty())
      continue;
    const bool is_first = tables_[link].is_empty();
    if (!add(link) && !is_first) {
      // Places of long ago make room.
      tables_[link].clear();
      add(link);
    }
    tables_[link].fill(threads);
  }
}

}  // namespace fringe::detail
