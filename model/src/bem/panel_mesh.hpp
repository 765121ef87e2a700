#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "bem/hidden_surface.hpp"
#include "bem/panel.hpp"

/// Surfaces of triangles as panels in groups (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

inline Eigen::Index index_of(std::size_t k) {
  return static_cast<Eigen::Index>(k);
}

/// Consecutive panels that are neighbours, or the quarters of one triangle. The coarse space of charges has
/// one density on each group.
struct PanelGroup {
  std::size_t first;
  std::size_t count;
  std::size_t body;
  bool is_quartered;  ///< true if the panels are the quarters of one triangle, in the order of quarters()
};

/// Fraction of rtol that panels graded towards sharp edges may miss with one density on each group. It is
/// about the change from the coarse to the whole space.
constexpr double grading_part = 1.0 / 3;

/// A-priori grading takes at most one in so many of the allowed panels: the others are for refinement.
constexpr std::size_t most_graded_part = 4;

/// Limits of the a-priori grading towards sharp edges.
struct PanelGrading {
  double missing = 1;  ///< fraction of a body's energy that one density on each group may miss
  std::size_t most_panels = 0;
};

/// The panels of bodies of triangles, in groups that can be refined.
class PanelMesh {
 public:
  /// Parts of the surfaces that `hidden` contains get no panels.
  explicit PanelMesh(std::shared_ptr<const HiddenSurface> hidden = nullptr) : hidden_(std::move(hidden)) {}

  /// Adds a body's surface. A surface of many triangles begins with these as panels; one of few begins with
  /// their quarters or, if graded towards sharp edges, with the quarters of their parts.
  void add(std::size_t body, std::span<const Triangle> surface, const PanelGrading& grading = {});

  const std::vector<Panel>& panels() const { return panels_; }
  const std::vector<PanelGroup>& groups() const { return groups_; }

  /// Returns the group of every panel.
  std::vector<Eigen::Index> group_of_panels() const;

  /// Returns the mesh of the first `bodies` bodies.
  PanelMesh of_first(std::size_t bodies) const;

  /// Returns the triangles of a group: the one that was quartered, or its panels.
  std::vector<Triangle> triangles(const PanelGroup& group) const;

  /// Returns for every panel its index before the last refinement; no_place if it is new.
  const std::vector<Eigen::Index>& places_before() const { return places_before_; }
  static constexpr Eigen::Index no_place = -1;

  /// Returns the number of panels that refining a group adds.
  static std::size_t growth(const PanelGroup& group);

  /// Refines marked groups: each of their triangles, or each half of a quartered triangle, becomes a group of
  /// its own. Triangles are halved across the side along which the density changes most, by the charges of
  /// all panels (rows) in all columns.
  void refine(const std::vector<bool>& marked, const Eigen::MatrixXd& charges);

 private:
  void add_quartered(const Triangle& triangle, std::size_t body);
  bool is_hidden(const Triangle& triangle, std::size_t body) const {
    return hidden_ != nullptr && hidden_->contains(triangle, body);
  }

  std::shared_ptr<const HiddenSurface> hidden_;

  std::vector<Panel> panels_;
  std::vector<PanelGroup> groups_;
  std::vector<Eigen::Index> places_before_;
};

}  // namespace fringe::detail
