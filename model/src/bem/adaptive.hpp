#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

/// The loop of all boundary elements: solve, estimate, mark, refine.
namespace fringe::detail {

/// Factor by which a refinement aims below the allowed error, to save a further refinement for a small
/// excess.
constexpr double excess_margin = 1.25;

/// Describes the next refinement by the errors of a solution.
struct Assessment {
  bool is_last = false;        ///< the solution is accurate enough, or more accuracy out of reach
  Eigen::VectorXd indicators;  ///< the energy that each group of panels misses
  double allowed = 0;          ///< the energy that may still be missing after the refinement
  std::size_t most_added = 0;  ///< number of panels that it may add
  int most_steps = 1;          ///< in which a group may be refined at once
};

/// Steps in which a triangle is refined at most before the next solution. Charges that grow towards an edge
/// are met by triangles that are far smaller there; with three steps instead, nine robot arms took up to 1.4
/// times as long, and with one, arms with covered sensors twice as long or had no answer.
constexpr int most_steps_at_once = 5;

/// How many panels a refinement adds at most: as many as the error requires, if it falls with the unknowns as
/// it did in the refinement before. The first adds few: errors are large at few places then, where many steps
/// are better than many panels (nine robot arms).
class PanelGrowth {
 public:
  /// Takes the error of the next solution, over what is allowed, and its number of unknowns.
  void measure(double excess, std::size_t unknowns);

  std::size_t most_added(std::size_t panels) const;

 private:
  double excess_ = 0;
  std::size_t unknowns_ = 0;
  bool is_first_ = true;
  double power_ = 5;  ///< of the number of unknowns, with which the error falls
};

/// Equations whose unknowns are refined until their solution is accurate enough.
class AdaptiveProblem {
 public:
  AdaptiveProblem() = default;
  AdaptiveProblem(const AdaptiveProblem&) = delete;
  AdaptiveProblem& operator=(const AdaptiveProblem&) = delete;
  virtual ~AdaptiveProblem() = default;

  virtual const std::vector<PanelGroup>& groups() const = 0;
  /// Solves with the present unknowns.
  virtual Assessment solve() = 0;
  /// Refines the marked groups of panels, and whatever else by the last solution; `steps` is empty if no
  /// panels are marked. Returns false if there is nothing to refine.
  virtual bool refine(const std::vector<int>& steps) = 0;
};

/// Solves and refines by turns until a solution is the last one or nothing may be refined.
void solve_adaptively(AdaptiveProblem& problem);

}  // namespace fringe::detail
