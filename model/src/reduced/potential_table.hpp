#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "reduced/outside_potentials.hpp"

namespace fringe::detail {

/// Potentials outside a machine, tabulated in cubes that are the smaller the nearer they are to it, by
/// polynomials through Chebyshev's nodes.
class PotentialTable {
 public:
  /// Number of nodes of a cell, `nodes_per_side` along each axis.
  static constexpr std::size_t nodes_per_side = 4;
  static constexpr std::size_t nodes = nodes_per_side * nodes_per_side * nodes_per_side;

  /// Keeps a reference to the potentials.
  /// @param largest side of the largest cells, m
  PotentialTable(const OutsidePotentials& potentials, double largest);

  /// Makes sure that there is a cell around a point, unless the point is too close to the machine or too far
  /// from the origin, or there are too many cells. The cell is empty until fill() is called. Returns false if
  /// there are too many.
  bool add(const Eigen::Vector3d& point);
  /// Makes cells by a function that returns false where there are too many: then places of long ago make
  /// room, and it is called again. Returns true if they did.
  template <typename Add>
  bool make_room_for(const Add& add_all) {
    const bool is_first = cells_.empty();
    if (add_all() || is_first)
      return false;
    clear();
    add_all();
    return true;
  }
  /// Returns the centres of all cells.
  std::vector<Eigen::Vector3d> centres() const;
  std::size_t count() const { return cells_.size(); }
  /// Removes all cells.
  void clear();
  /// Empties all cells.
  void forget_values() { values_.clear(); }
  /// Finds the potentials at the nodes of all empty cells: those of the given charges and behind them those
  /// of combinations (columns) of the functions. The same bits for any number of threads.
  void fill(const Eigen::MatrixXf& charges, std::size_t threads);

  /// Returns the number of the cell around a point, if there is one.
  std::optional<std::size_t> find(const Eigen::Vector3d& point) const;
  /// Tells whether a point lies in a cell.
  bool contains(std::size_t cell, const Eigen::Vector3d& point) const;
  /// Adds a multiple of the weights with which the values at the nodes of a cell make that at a point of it.
  void add_weights(std::size_t cell, const Eigen::Vector3d& point, float factor,
                   std::array<float, nodes>& weights) const;
  /// Weights of the nodes for the three components of a gradient and the three of its moment.
  using WrenchWeights = std::array<std::array<float, nodes>, 6>;
  /// Adds a multiple of the weights with which the values at the nodes of a cell make the gradient at a point
  /// of it, and the moment of this about the cell's centre.
  void add_wrench_weights(std::size_t cell, const Eigen::Vector3d& point, float factor,
                          WrenchWeights& weights) const;
  const Eigen::Vector3d& centre(std::size_t cell) const { return cells_[cell].centre; }
  /// Returns the side of the smallest cells that there may be, m.
  double least_side() const;
  /// Returns the values of a cell: for every node a row of width() values.
  const float* values(std::size_t cell) const { return values_.data() + cell * nodes * width_; }
  /// Returns the number of values at a node, filled up to a whole block.
  std::size_t width() const { return width_; }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.cells_, self.values_, self.width_);
    if constexpr (!std::is_const_v<Self>)
      self.number_cells();
  }

 private:
  struct Cell {
    Eigen::Vector3d centre;
    double half;

    template <typename Archive, typename Self>
    static void describe(Archive& archive, Self& self) {
      archive(self.centre, self.half);
    }
  };

  void number_cells();
  static std::uint64_t key(const Eigen::Vector3d& point, unsigned level, double side);

  const OutsidePotentials& potentials_;
  double largest_;
  std::unordered_map<std::uint64_t, std::int64_t> places_;  ///< numbers of cells; negative: divided, or none
  std::vector<Cell> cells_;
  std::vector<float> values_;
  std::size_t width_ = 0;
};

}  // namespace fringe::detail
