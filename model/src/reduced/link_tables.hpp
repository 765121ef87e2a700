#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "reduced/link_couplings.hpp"
#include "reduced/linked_machine.hpp"
#include "reduced/potential_table.hpp"
#include "reduced/table_forces.hpp"

namespace fringe::detail {

/// Arrays for potentials and forces beside links, that are used again.
struct BesideLink {
  /// A point close to a link, as at a joint, a share of the charge of a row.
  struct Near {
    Eigen::Vector3d at;
    Eigen::Index row;
    float share;
  };
  TablePotentials potentials;
  std::vector<Near> near;
  LimitedPoints of_row;
  std::vector<float> shares, at_link;
  TableForces forces;
  PointForces near_forces;
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
  PotentialTable& table() { return table_; }
  /// Evaluates the potentials in new cells. The same bits for any number of threads.
  void fill(std::size_t threads);
  /// Writes the potentials of the given charges (columns) on other functions (rows) in a pose and, in the
  /// rows behind these, their energies with each of the charges that the others carry for loads.
  void write(const ChargeFunctions& others, const Eigen::Isometry3d& pose, TrianglePotentials& given,
             BesideLink& workspace) const;
  /// Finds the forces on other functions of unit charge in a pose, in the frame of the link, in the fields of
  /// the given charges that the link's loads have.
  /// @param loads number of fields: those of loads that the link does not carry are zero
  /// @param carried the loads that it carries
  void find_forces(const ChargeFunctions& others, const Eigen::Isometry3d& pose, Eigen::Index loads,
                   const std::vector<Eigen::Index>& carried, BesideLink& workspace, Forces& forces) const;

 private:
  std::size_t level(const ChargeFunctions& others, std::size_t function, const Eigen::Isometry3d& pose,
                    std::size_t coarsest = 0) const;
  void add_near(BesideLink& workspace, TrianglePotentials& given) const;

  const ChargeFunctions& functions_;
  OutsidePotentials potentials_;
  PotentialTable table_;
  // The link's points for places that are in no cell, with the given charges there (columns).
  LimitedPoints near_;
  Eigen::MatrixXf near_charges_;
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
