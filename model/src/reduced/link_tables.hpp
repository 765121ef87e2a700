#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "reduced/linked_machine.hpp"
#include "reduced/potential_table.hpp"
#include "reduced/table_forces.hpp"

namespace fringe::detail {

/// Points close to a link, as at a joint, with the rows that they are shares of, and memory for the
/// potentials there.
struct NearPoints {
  struct Share {
    Eigen::Vector3d at;
    Eigen::Index row;
    float share;
  };
  std::vector<Share> shares;
  std::vector<float> potentials;          ///< of unit charges
  std::vector<float> of_chunk, of_loads;  ///< of the given charges, a block of places for each load
};

/// The potentials of what a link carries for the loads, tabulated in its frame. On the far side of a housing
/// they nearly cancel, so that they are computed from the panels.
class LinkTable {
 public:
  /// Keeps a reference to the functions of the link.
  /// @param largest side of the largest cells, m
  LinkTable(const ChargeFunctions& functions, double largest);
  LinkTable(const LinkTable&) = delete;
  LinkTable& operator=(const LinkTable&) = delete;

  /// Makes cells where other functions are in a pose, from their frame to that of the link. Returns false if
  /// there are too many.
  bool add(const ChargeFunctions& others, const Eigen::Isometry3d& pose);
  /// Forgets all places.
  void clear() { table_.clear(); }
  bool is_empty() const { return table_.count() == 0; }
  /// Evaluates the potentials in new cells. The same bits for any number of threads.
  void fill(std::size_t threads);
  /// Writes the potentials of the given charges (columns) on other functions (rows) in a pose and, in the
  /// rows behind these, their energies with each of the charges that the others carry for loads.
  void write(const ChargeFunctions& others, const Eigen::Isometry3d& pose, Eigen::MatrixXf& given,
             NearPoints& workspace) const;
  /// Finds the forces on other functions of unit charge in a pose, in the frame of the link, in the fields of
  /// the given charges that the link's loads have.
  /// @param loads number of fields: those of loads that the link does not carry are zero
  /// @param carried the loads that it carries
  void find_forces(const ChargeFunctions& others, const Eigen::Isometry3d& pose, Eigen::Index loads,
                   const std::vector<Eigen::Index>& carried, TableForces& workspace, Forces& forces) const;

 private:
  void add_near(NearPoints& workspace, Eigen::MatrixXf& given) const;
  void add_near_force(const Eigen::Vector3d& place, std::size_t function, float share,
                      const std::vector<Eigen::Index>& carried, Forces& forces) const;

  const ChargeFunctions& functions_;
  OutsidePotentials potentials_;
  PotentialTable table_;
  // The link's points for places that are in no cell, in whole blocks.
  std::vector<float> near_x_, near_y_, near_z_;
  std::vector<float> near_limits_;  ///< largest potentials of unit charges
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> near_charges_;
};

/// The tables of all links of a machine.
class LinkTables {
 public:
  /// Prepares nothing yet. Keeps references to the links.
  LinkTables(const LinkedMachine& machine, const TargetAtRest& target);

  /// Prepares what the targets and the other links meet in some poses; costs little where they have been near
  /// before.
  void extend(const LinkedMachine& machine, const TargetAtRest& target, std::span<const PoseOfMachine> poses,
              std::size_t threads);

  const LinkTable& of(std::size_t link) const { return tables_[link]; }

 private:
  std::deque<LinkTable> tables_;
  std::vector<std::optional<Eigen::Isometry3d>> before_;  ///< poses of the links relative to one
};

}  // namespace fringe::detail
