#include "reduced/link_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// The level of the link's points for places that are in no cell.
constexpr std::size_t level_of_near = 2;

/// The level of the others' points where these are in no cell.
constexpr std::size_t level_at_near = 1;

/// Largest potential of one of n points of a function, times the function's radius over √n: about that in the
/// middle of its part of the surface.
constexpr double most_of_part = 2;

/// Returns the largest potential of a point of a link's function.
double limit_of_part(const ChargeFunctions& link, std::size_t function) {
  const auto count = static_cast<double>(link.points(level_of_near).count(function));
  return most_of_part * std::sqrt(count) / link.radius(function);
}

}  // namespace

LinkTable::LinkTable(const ChargeFunctions& functions, double largest)
    : functions_(functions), potentials_(functions), table_(potentials_, largest) {
  const FunctionPoints& points = functions.points(level_of_near);
  for (std::size_t function = 0; function < functions.count(); ++function)
    for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k)
      near_.add(points.at[k], static_cast<float>(limit_of_part(functions, function)));
  near_.fill_up();
  near_charges_.setZero(index_of(near_.limits.size()), points.given.cols());
  near_charges_.topRows(points.given.rows()) = points.given;
}

/// Returns the level of a function beside the link. Those whose centres are in no cell have a few points.
std::size_t LinkTable::level(const ChargeFunctions& others, std::size_t function, const Isometry3d& pose,
                             std::size_t coarsest) const {
  const std::size_t level = std::max(others.level(function, pose, functions_.boxes()), coarsest);
  return level > level_at_near && !table_.find(pose * others.centre(function)) ? level_at_near : level;
}

/// Adds the potentials of the given charges at points close to the link to the rows that these are shares
/// of. Charges are points, too.
void LinkTable::add_near(BesideLink& workspace, TrianglePotentials& given) const {
  const std::vector<BesideLink::Near>& near = workspace.near;
  workspace.at_link.resize(near_.limits.size());
  for (std::size_t first = 0, end = 0; first < near.size(); first = end) {
    workspace.of_row.clear();
    workspace.shares.clear();
    for (; end < near.size() && near[end].row == near[first].row; ++end) {
      workspace.of_row.add(near[end].at.cast<float>(), 0);
      workspace.shares.push_back(near[end].share);
    }
    // The potential of a point at another is that of the other at it.
    best_kernels<NodeKernels>().add_up_limited(workspace.of_row.points(), workspace.shares.data(),
                                               std::numeric_limits<float>::max(), near_.points(),
                                               near_.limits.data(), workspace.at_link.data());
    const Eigen::Map<const Eigen::VectorXf> at_link(workspace.at_link.data(), near_charges_.rows());
    for (Index load = 0; load < near_charges_.cols(); ++load)
      given(near[first].row, load) += near_charges_.col(load).dot(at_link);
  }
}

bool LinkTable::add(const ChargeFunctions& others, const Isometry3d& pose) {
  bool have_cells = true;
  const auto add_point = [&](const Vector3d& at) { have_cells = table_.add(at) && have_cells; };
  for (std::size_t function = 0; function < others.count(); ++function)
    add_point(pose * others.centre(function));
  others.visit_points(
      pose, [&](std::size_t function) { return level(others, function, pose); },
      [&](const Vector3d& at, std::size_t, const FunctionPoints&, std::size_t) { add_point(at); });
  return have_cells;
}

void LinkTable::fill(std::size_t threads) {
  table_.fill(MatrixXf(static_cast<Index>(functions_.count()), 0), threads);
}

void LinkTable::write(const ChargeFunctions& others, const Isometry3d& pose, TrianglePotentials& given,
                      BesideLink& workspace) const {
  const Index functions = index_of(others.count()), carried = others.panels().given.cols() / 2;
  given.setZero(functions + carried, index_of(table_.width()));
  if (functions_.panels().given.cols() == 0)
    return;
  workspace.potentials.start(table_, given);
  workspace.near.clear();
  const auto add = [&](const Vector3d& at, Index row, float charge) {
    if (!workspace.potentials.add(at, row, charge))
      workspace.near.push_back({at, row, charge});
  };
  others.visit_points(
      pose, [&](std::size_t function) { return level(others, function, pose); },
      [&](const Vector3d& at, std::size_t function, const FunctionPoints& points, std::size_t k) {
        add(at, index_of(function), points.shares[k]);
      });
  for (Index load = 0; load < carried; ++load)
    others.visit_points(
        pose,
        [&](std::size_t function) {
          return level(others, function, pose, ChargeFunctions::first_with_moments);
        },
        [&](const Vector3d& at, std::size_t, const FunctionPoints& points, std::size_t k) {
          add(at, functions + load, points.given(index_of(k), load));
        });
  workspace.potentials.finish();
  add_near(workspace, given);
}

void LinkTable::find_forces(const ChargeFunctions& others, const Isometry3d& pose, Index loads,
                            const std::vector<Index>& carried, BesideLink& workspace, Forces& forces) const {
  forces.setZero(6 * index_of(others.count()), loads);
  if (carried.empty())
    return;
  MatrixXf factors = MatrixXf::Zero(index_of(table_.width()), loads);
  std::vector<float>& charges = workspace.near_forces.start(near_, static_cast<std::size_t>(loads));
  for (std::size_t load = 0; load < carried.size(); ++load) {
    factors(index_of(load), carried[load]) = 1;
    for (std::size_t k = 0; k < near_.count; ++k)
      charges[k * static_cast<std::size_t>(loads) + static_cast<std::size_t>(carried[load])] =
          near_charges_(index_of(k), index_of(load));
  }
  workspace.forces.start(table_, factors);
  others.visit_points(
      pose, [&](std::size_t function) { return level(others, function, pose); },
      [&](const Vector3d& at, std::size_t function, const FunctionPoints& points, std::size_t k) {
        // Only the link's own points are limited.
        if (!workspace.forces.add(at, function, points.shares[k], forces))
          workspace.near_forces.add(
              {at.cast<float>(), index_of(function), points.shares[k], std::numeric_limits<float>::max()},
              forces);
      });
  workspace.forces.finish(forces);
  workspace.near_forces.finish(forces);
}

LinkTables::LinkTables(const LinkedMachine& machine, const TargetAtRest& target) {
  // The largest cells are as large as all targets.
  for (const MachineLink& link : machine.links())
    tables_.emplace_back(link.functions(), target.size());
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
        if (other == link || (before_[other] && are_equal(*before_[other], relative)))
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
    tables_[link].table().make_room_for([&] { return add(link); });
    tables_[link].fill(threads);
  }
}

}  // namespace fringe::detail
