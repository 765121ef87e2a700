#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/panel.hpp"

/// Bodies of triangles as panels in groups (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

/// Panels that follow each other: neighbours, or the quarters of one triangle. The smaller space of charges
/// has one density on each group.
struct PanelGroup {
  std::size_t first;
  std::size_t count;
  std::size_t body;
  bool is_quartered;  ///< one triangle, whose quarters the panels are, as `quarters` has them
};

/// How far panels are divided towards sharp edges before anything is solved for.
struct PanelGrading {
  double missing = 1;  ///< the part of a body's energy that one density on each group may miss
  std::size_t most_panels = 0;
};

class PanelMesh {
 public:
  /// A surface of many triangles begins with its own triangles as panels, one of few with the quarters of
  /// these or, towards sharp edges, of their parts.
  void add(std::size_t body, std::span<const Triangle> triangles, const PanelGrading& grading = {});

  const std::vector<Panel>& panels() const { return panels_; }
  const std::vector<PanelGroup>& groups() const { return groups_; }

  /// The panels of so many bodies, the first.
  PanelMesh of_first(std::size_t bodies) const;

  /// What a group is made of: the triangle that was quartered, or its panels.
  std::vector<Triangle> triangles(const PanelGroup& group) const;

  /// For every panel where it stood before the last refinement; no_place if it is new.
  const std::vector<Eigen::Index>& places_before() const { return places_before_; }
  static constexpr Eigen::Index no_place = -1;

  /// How many panels more it makes to refine a group.
  static std::size_t growth(const PanelGroup& group);

  /// Takes the triangles of marked groups, or the halves of those that were quartered, for groups of their
  /// own. They are halved across the side along which the density changes most: a column of `charges` holds
  /// those of all panels, for the larger of several columns.
  void refine(const std::vector<bool>& marked, const Eigen::MatrixXd& charges);

 private:
  void add_quartered(const Triangle& triangle, std::size_t body);

  std::vector<Panel> panels_;
  std::vector<PanelGroup> groups_;
  std::vector<Eigen::Index> places_before_;
};

}  // namespace fringe::detail
