#pragma once

#include <cstddef>
#include <functional>

#include <Eigen/Geometry>

#include "bem/adaptive.hpp"
#include "bem/panel_system.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// Conductors that keep their poses, solved by boundary elements of triangles: what surface_charges() and the
/// readings before a machine (model/CORRECTIONS.md, section 8) prepare from.
class ConductorsAtRest : private AdaptiveProblem {
 public:
  /// Solves for every conductor at unit potential, the others grounded. Panels are refined until the stated
  /// errors of the diagonal entries that are asked for are within `rtol`, as far as `most_panels` allow.
  /// There are at least `least_panels`, even if the entries do not need them; with an `importance` of the
  /// boxes around groups of panels, so many more than without it, where that is largest.
  /// @throws std::runtime_error if the matrix is not positive definite.
  ConductorsAtRest(ChargedBodies bodies, double rtol, std::size_t most_panels, std::size_t least_panels = 0,
                   std::size_t threads = 1,
                   const std::function<double(const Eigen::AlignedBox3d&)>& importance = {});

  const ChargedBodies& bodies() const { return bodies_; }
  const PanelMesh& mesh() const { return system_.mesh(); }
  const PanelOperator& panel_operator() const { return system_.panel_operator(); }
  /// Returns the charge of every panel (rows) for every conductor at unit potential.
  const Eigen::MatrixXd& charges() const { return solution_.charges; }
  /// Returns the same with one density on each group of panels.
  const Eigen::MatrixXd& coarse_charges() const { return solution_.coarse_charges; }
  /// Returns the Maxwell matrix of all conductors, in metres (to be multiplied by 4πε).
  const Eigen::MatrixXd& matrix() const { return solution_.all.fine; }
  /// Returns the largest stated error of the diagonal entries that are asked for, relative to these.
  double error() const { return error_; }

 private:
  const std::vector<PanelGroup>& groups() const override { return mesh().groups(); }
  Assessment solve() override;
  bool refine(const std::vector<int>& steps) override;

  ChargedBodies bodies_;
  PanelSystem system_;
  double rtol_;
  double tolerance_;
  std::size_t most_panels_;
  PanelSolution solution_;
  double error_ = 0;
};

}  // namespace fringe::detail
