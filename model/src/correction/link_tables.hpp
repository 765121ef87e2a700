#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include <Eigen/Geometry>

#include "correction/moving_machine.hpp"
#include "correction/potential_table.hpp"

namespace fringe::detail {

/// The potentials of what a link carries for the loads, tabulated in its frame. On the far side of a housing
/// they nearly cancel, so that they are computed from the panels.
class LinkTable {
 public:
  /// Keeps a reference to the functions of the link.
  /// @param largest side of the largest cells, m
  LinkTable(const ChargeFunctions& functions, double largest);
  LinkTable(const LinkTable&) = delete;
  LinkTable& operator=(const LinkTable&) = delete;

  /// Forgets the places of long ago if no more cells are made.
  void make_room();
  /// Makes cells where other functions are in a pose, from their frame to that of the link.
  void add(const ChargeFunctions& others, const Eigen::Isometry3d& pose);
  /// Evaluates the potentials in new cells. The same bits for any number of threads.
  void fill(std::size_t threads);
  /// Writes the potentials of the given charges (columns) on other functions (rows) in a pose.
  void write(const ChargeFunctions& others, const Eigen::Isometry3d& pose, Eigen::MatrixXf& given) const;

 private:
  const ChargeFunctions& functions_;
  OutsidePotentials potentials_;
  PotentialTable table_;
};

/// The tables of all links of a machine.
class LinkTables {
 public:
  /// Prepares nothing yet. Keeps references to the links.
  LinkTables(const MovingMachine& machine, const TargetAtRest& target);

  /// Prepares what the targets and the other links meet in some poses; costs little where they have been near
  /// before.
  /// @param links the poses of the links' frames, for each pose
  /// @param frames the poses of the targets' frame
  void extend(const MovingMachine& machine, const TargetAtRest& target,
              const std::vector<std::vector<Eigen::Isometry3d>>& links,
              const std::vector<Eigen::Isometry3d>& frames, std::size_t threads);

  const LinkTable& of(std::size_t link) const { return tables_[link]; }

 private:
  std::deque<LinkTable> tables_;
};

}  // namespace fringe::detail
