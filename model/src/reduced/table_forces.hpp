#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/wrench.hpp"
#include "reduced/linked_machine.hpp"
#include "reduced/potential_table.hpp"

namespace fringe::detail {

/// The forces on functions of unit charge, three components, and their torques about the origin, three, in
/// some fields: six rows for each function, a column for each field.
using Forces = Eigen::MatrixXd;

/// Adds to each reading's wrench the forces on charges of functions (rows) for the loads (columns): those in
/// the field of what the reading drives on the charges for what it senses, and the other way round.
void add_wrenches(const std::vector<OfReading>& readings, const Eigen::MatrixXf& charges,
                  const Forces& forces, std::vector<Wrench>& wrenches);

/// Adds potentials of all that a table has to those on functions (rows), with arrays that are used again.
class TablePotentials {
 public:
  /// Begins with a table and rows of width() numbers.
  void start(const PotentialTable& table, TrianglePotentials& rows);
  /// Adds the potentials at a point to a row, times a factor. Returns false for a point that is in no cell.
  bool add(const Eigen::Vector3d& point, Eigen::Index row, float factor);
  /// Adds those at the last points.
  void finish();

 private:
  /// Largest number of cells whose points are added up before their nodes' values are.
  static constexpr std::size_t most_cells = 16;

  const PotentialTable* table_ = nullptr;
  TrianglePotentials* rows_ = nullptr;
  Eigen::Index row_ = 0;
  std::vector<std::size_t> cells_;  ///< around the points of one row
  std::size_t in_cell_ = 0;         ///< the place of that of the last point
  std::array<std::array<float, PotentialTable::nodes>, most_cells> weights_{};
  std::array<float, PotentialTable::nodes> unused_{};
  std::vector<float> none_, sums_;
};

/// Evaluates forces in fields that are combinations of what a table has, with arrays that are used again.
class TableForces {
 public:
  /// Begins with fields: the factors (columns) of all values at a node, width() of them.
  void start(const PotentialTable& table, const Eigen::MatrixXf& factors);
  /// Adds the forces on a share of a function's charge. Returns false for a point that is in no cell.
  bool add(const Eigen::Vector3d& point, std::size_t function, float share, Forces& forces);
  /// Adds the forces on the points since the last cell.
  void finish(Forces& forces);

 private:
  const float* nodes_of(std::size_t cell);

  const PotentialTable* table_ = nullptr;
  Eigen::MatrixXf factors_;
  std::vector<std::size_t> places_;  ///< of every cell's fields in the next array; `none` where it has none
  std::vector<float> at_nodes_, unused_;
  std::optional<std::size_t> cell_;
  std::size_t function_ = 0;
  PotentialTable::WrenchWeights weights_{};
};

}  // namespace fringe::detail
