#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/surface_charges.hpp"
#include "reduced/charge_functions.hpp"
#include "reduced/node_kernels.hpp"

namespace fringe::detail {

/// Returns the indices of points along Morton's space-filling curve, so that neighbours in it lie close
/// together. Points of the same code stay in their order.
std::vector<std::size_t> along_curve(std::span<const Eigen::Vector3d> points);

/// Charges on the functions of a machine: those of a function follow each other, in whole blocks.
struct FunctionCharges {
  std::vector<float> values;
  Eigen::Index count;   ///< of the charges on a function
  Eigen::Index stride;  ///< the same in whole blocks

  /// @param charges distributions (columns) of charges on the functions (rows)
  explicit FunctionCharges(const Eigen::MatrixXf& charges);
};

/// The potentials of a machine's charges at points outside it: functions that are close count as panels, the
/// others as up to 64 points.
class OutsidePotentials {
 public:
  /// Number of points that are evaluated together, by the same points of the functions.
  static constexpr std::size_t block = node_block;

  /// Keeps a reference to the functions.
  explicit OutsidePotentials(const ChargeFunctions& functions);

  struct Values {
    TrianglePotentials of_given;      ///< of the given charges (columns) at the points
    TrianglePotentials of_functions;  ///< 1/m, of unit charges on the functions or of combinations of them
  };

  /// Evaluates the potentials at points.
  /// @param with_functions whether the functions' potentials are asked for; else these have no columns
  /// @param charges combinations (columns) of the functions; null: every function for itself
  Values at(std::span<const Eigen::Vector3d> points, bool with_functions, const Eigen::MatrixXf* charges,
            std::size_t threads) const;

  /// Memory of an evaluation, and the potentials that it found: a block for each charge.
  struct Scratch {
    std::vector<float> of_given, of_functions, of_charges;
    std::vector<float> inverse_distances, of_rule, sums;
    std::vector<std::size_t> close;
    std::vector<std::array<std::size_t, 2>> near;  ///< a panel, and the place of its 1/r at a point
    std::vector<double> means;
  };

  /// Evaluates up to one block of points.
  /// @param charges combinations of the functions; null: none
  void evaluate(std::span<const Eigen::Vector3d> points, bool with_functions, const FunctionCharges* charges,
                Scratch& scratch) const;

  std::size_t panels() const { return panels_.size(); }
  Eigen::Index given() const { return functions_.panels().given.cols(); }
  /// Returns the distance of a point from the nearest panel.
  double clearance(const Eigen::Vector3d& point) const;

 private:
  /// A panel as a point.
  struct PanelPoint {
    Eigen::Vector3d centre;
    double radius;
  };

  /// The coordinates of a block of points.
  using Coordinates = std::array<std::array<float, block>, 3>;

  /// The points of a quadrature rule on every panel, one panel after the other.
  struct PanelRule {
    double from;  ///< distance from a panel's centre, over its radius, from which on the rule is used
    std::vector<float> weights;
    std::vector<float> x, y, z;
  };

  /// Points in whose place functions count: at each the share of its function's charge, then the given
  /// charges.
  struct Sources {
    std::vector<std::size_t> first;  ///< for each function its first point, and the end
    std::vector<float> x, y, z, charges;
  };

  void add_sources(const FunctionPoints& points);
  void add_rule(double from, int degree);
  void add_potentials(const Sources& sources, std::size_t function, const float* inverse_distances,
                      bool with_functions, Scratch& scratch) const;
  void correct(std::span<const Eigen::Vector3d> points, const Coordinates& at, Scratch& scratch) const;

  const ChargeFunctions& functions_;
  std::vector<PanelPoint> panels_;
  std::vector<PanelRule> rules_;  ///< the nearest first
  std::vector<Sources> levels_;   ///< the coarsest first; the last are the panels' centres
};

}  // namespace fringe::detail
