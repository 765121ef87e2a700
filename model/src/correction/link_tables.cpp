#include "correction/link_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "correction/link_couplings.hpp"
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

/// Calls a function with every point of functions beside a link, the number of its function and its share.
/// Functions whose centres are in no cell of the table have a few points.
template <typename Visit>
void visit_points_beside(const ChargeFunctions& functions, const Isometry3d& pose,
                         const ChargeFunctions& of_link, const PotentialTable& table, const Visit& visit) {
  for (std::size_t function = 0; function < functions.count(); ++function) {
    std::size_t level = level_beside(functions, function, pose, of_link.boxes());
    if (level > level_at_near && !table.find(pose * functions.centre(function)))
      level = level_at_near;
    const FunctionPoints& points = functions.points(level);
    for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k)
      visit(pose * points.at[k].cast<double>(), function, points.shares[k]);
  }
}

/// Adds the potentials of a link's given charges at points close to it, as at a joint, to the functions that
/// these are parts of. Charges are points, too.
void add_near(const ChargeFunctions& link, const std::vector<Vector3d>& places,
              const std::vector<std::pair<Index, float>>& parts, MatrixXf& given) {
  const auto& kernels = best_kernels<NodeKernels>();
  const FunctionPoints& points = link.points(level_of_near);
  const auto count = static_cast<std::ptrdiff_t>(points.at.size()), padded = whole_blocks(count);
  const auto size = static_cast<std::size_t>(padded);
  std::vector<float> x(size, padded_coordinate), y(x), z(x), limits(size, 1.0F), potentials(size);
  MatrixXf charges = MatrixXf::Zero(padded, points.given.cols());
  charges.topRows(count) = points.given;
  for (std::size_t k = 0; k < points.at.size(); ++k)
    x[k] = points.at[k].x(), y[k] = points.at[k].y(), z[k] = points.at[k].z();
  for (std::size_t function = 0; function < link.count(); ++function) {
    const std::size_t first = points.first[function], end = points.first[function + 1];
    const double of_part = most_of_part * std::sqrt(static_cast<double>(end - first)) / link.radius(function);
    std::fill(limits.begin() + static_cast<std::ptrdiff_t>(first),
              limits.begin() + static_cast<std::ptrdiff_t>(end), static_cast<float>(of_part));
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Eigen::Vector3f at = places[k].cast<float>();
    kernels.fill({&at.x(), &at.y(), &at.z(), 1}, {x.data(), y.data(), z.data(), count}, potentials.data());
    // At the same place the potential is not a number, which is not less than the limit.
    for (std::size_t source = 0; source < size; ++source)
      potentials[source] = std::min(limits[source], potentials[source]);
    for (Index load = 0; load < given.cols(); ++load)
      given(parts[k].first, load) +=
          parts[k].second * kernels.dot(potentials.data(), charges.col(load).data(), padded);
  }
}

}  // namespace

LinkTable::LinkTable(const ChargeFunctions& functions, double largest)
    : functions_(functions), potentials_(functions, true), table_(potentials_, largest) {}

void LinkTable::add(const ChargeFunctions& others, const Isometry3d& pose) {
  for (std::size_t function = 0; function < others.count(); ++function)
    table_.add(pose * others.centre(function));
  visit_points_beside(others, pose, functions_, table_,
                      [&](const Vector3d& at, std::size_t, float) { table_.add(at); });
}

void LinkTable::make_room() {
  if (table_.is_full())
    table_.clear();
}

void LinkTable::fill(std::size_t threads) {
  table_.fill(MatrixXf(static_cast<Index>(functions_.count()), 0), threads);
}

void LinkTable::write(const ChargeFunctions& others, const Isometry3d& pose, MatrixXf& given) const {
  const Index count = functions_.panels().given.cols();
  given.setZero(static_cast<Index>(others.count()), count);
  if (count == 0)
    return;
  std::array<float, PotentialTable::nodes> weights{};
  std::optional<std::size_t> cell;
  std::size_t current = 0;
  const auto finish = [&] {
    if (!cell)
      return;
    const Eigen::Map<const TableRows, 0, Eigen::OuterStride<>> values(
        table_.values(*cell), PotentialTable::nodes, count,
        Eigen::OuterStride<>(static_cast<Index>(table_.width())));
    given.row(static_cast<Index>(current)) +=
        Eigen::Map<const Eigen::RowVectorXf>(weights.data(), PotentialTable::nodes) * values;
    weights.fill(0);
    cell.reset();
  };
  std::vector<Vector3d> outside;
  std::vector<std::pair<Index, float>> parts;
  visit_points_beside(others, pose, functions_, table_,
                      [&](const Vector3d& at, std::size_t function, float share) {
                        if (function != current || !cell || !table_.contains(*cell, at)) {
                          finish();
                          current = function;
                          cell = table_.find(at);
                        }
                        if (cell) {
                          table_.add_weights(*cell, at, share, weights);
                        } else {
                          outside.push_back(at);
                          parts.emplace_back(static_cast<Index>(function), share);
                        }
                      });
  finish();
  if (!outside.empty())
    add_near(functions_, outside, parts, given);
}

LinkTables::LinkTables(const MovingMachine& machine, const TargetAtRest& target) {
  const double largest = side_of_largest_cells(target);
  for (const MachineLink& link : machine.links())
    tables_.emplace_back(link.functions(), largest);
}

void LinkTables::extend(const MovingMachine& machine, const TargetAtRest& target,
                        const std::vector<std::vector<Isometry3d>>& links,
                        const std::vector<Isometry3d>& frames, std::size_t threads) {
  for (std::size_t link = 0; link < tables_.size(); ++link) {
    if (machine.links()[link].loads().empty())
      continue;
    tables_[link].make_room();
    std::vector<std::optional<Isometry3d>> before(links.front().size());
    for (std::size_t pose = 0; pose < frames.size(); ++pose) {
      const Isometry3d to_link = links[pose][link].inverse(Eigen::Isometry);
      tables_[link].add(target.functions(), to_link * frames[pose]);
      for (std::size_t other = 0; other < before.size(); ++other) {
        const Isometry3d relative = to_link * links[pose][other];
        if (other == link || (before[other] && keep_relative_pose(*before[other], relative)))
          continue;
        tables_[link].add(machine.links()[other].functions(), relative);
        before[other] = relative;
      }
    }
    tables_[link].fill(threads);
  }
}

}  // namespace fringe::detail
