#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "correction/charge_functions.hpp"
#include "fringe/surface_charges.hpp"

namespace fringe::detail {

/// The potentials of a machine's charges at points outside it: functions that are close count as panels, the
/// others as up to 64 points.
class OutsidePotentials {
 public:
  /// Keeps a reference to the functions.
  /// @param is_fine whether charges that nearly cancel are to be resolved, for ten times the time
  explicit OutsidePotentials(const ChargeFunctions& functions, bool is_fine = false);

  struct Values {
    TrianglePotentials of_given;      ///< of the given charges (columns) at the points
    TrianglePotentials of_functions;  ///< 1/m, of unit charges on the functions or of combinations of them
  };

  /// Evaluates the potentials at points.
  /// @param with_functions whether the functions' potentials are asked for; else these have no columns
  /// @param charges combinations (columns) of the functions; null: every function for itself
  Values at(std::span<const Eigen::Vector3d> points, bool with_functions, const Eigen::MatrixXf* charges,
            std::size_t threads) const;

  std::size_t panels() const { return panels_.size(); }
  /// Returns the distance of a point from the nearest ball around a panel, 0 inside one.
  double clearance(const Eigen::Vector3d& point) const;

 private:
  /// A panel as a point.
  struct PanelPoint {
    Eigen::Vector3d centre;
    double radius;
  };

  /// The charges by which some points see a machine: a range for each function.
  struct Sources {
    std::vector<float> x, y, z, shares;
    std::vector<std::size_t> first;
    Eigen::MatrixXf given;
  };

  Sources sources(const Eigen::Vector3d& centre, double radius, std::vector<std::size_t>& close) const;
  void correct(std::span<const Eigen::Vector3d> points, const Sources& sources,
               const std::vector<std::size_t>& close, Eigen::Ref<TrianglePotentials> inverse_distances) const;
  void evaluate(std::span<const Eigen::Vector3d> points, std::span<const std::size_t> indices,
                Eigen::Index first, TrianglePotentials& of_given, TrianglePotentials& of_functions) const;

  const ChargeFunctions& functions_;
  bool is_fine_;
  std::vector<PanelPoint> panels_;
};

}  // namespace fringe::detail
