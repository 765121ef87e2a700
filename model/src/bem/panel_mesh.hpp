#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "surface/hidden_surface.hpp"
#include "surface/panel.hpp"
#include "surface/round_shape.hpp"

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

/// A-priori grading takes at most one in so many of the allowed panels, and no more than so many: the others
/// are for refinement, which knows the charges.
constexpr std::size_t most_graded_part = 4;
constexpr std::size_t most_graded_panels = 5000;

/// Limits of the a-priori grading towards sharp edges.
struct PanelGrading {
  double missing = 1;  ///< fraction of a body's energy that one density on each group may miss
  std::size_t most_panels = 0;
};

/// The panels of bodies of triangles, in groups that can be refined.
class PanelMesh {
 public:
  /// Largest number of triangles of a surface that are quartered. A larger surface has triangles enough of
  /// its own to group them for the coarse space.
  static constexpr std::size_t few_triangles = 400;

  /// Parts of the surfaces that `hidden` contains get no panels.
  explicit PanelMesh(std::shared_ptr<const HiddenSurface> hidden = nullptr) : hidden_(std::move(hidden)) {}

  /// Adds a body's surface. A surface of many triangles begins with these as panels; one of few begins with
  /// their quarters or, if graded towards sharp edges, with the quarters of their parts. Panels that are
  /// divided follow the round shape that the triangles stand for; null: they are the surface.
  void add(std::size_t body, std::span<const Triangle> surface, const PanelGrading& grading = {},
           const RoundShape* round = nullptr, std::size_t threads = 1);

  /// Divides the panels of a body that follow a round shape together with their neighbours from now on, so
  /// that no cracks open between them. All of its groups have to be quarters.
  void keep_closed(std::size_t body);

  const std::vector<Panel>& panels() const { return panels_; }
  const std::vector<PanelGroup>& groups() const { return groups_; }
  /// Tells whether the panels of a body that are divided follow a round shape.
  bool follows_shape(std::size_t body) const { return body < followed_.size() && followed_[body]; }

  /// Returns the group of every panel.
  std::vector<Eigen::Index> group_of_panels() const;

  /// Returns the triangles of a group: the one that was quartered, or its panels.
  std::vector<Triangle> triangles(const PanelGroup& group) const;

  /// Returns for every panel its index before the last refinement; no_place if it is new.
  const std::vector<Eigen::Index>& places_before() const { return places_before_; }
  static constexpr Eigen::Index no_place = -1;

  /// Refines groups, each of its triangles in so many steps; a group without a step stays. The first step
  /// makes a group of each triangle of several, all others make two of each: triangles are halved across the
  /// side along which the density changes most, or which is farthest from a round shape, by the charges of
  /// all panels (rows) in all columns; without columns across the longest side. Returns `carried`, further
  /// charges of all panels, on the new panels, with densities linear on each triangle.
  Eigen::MatrixXd refine(const std::vector<int>& steps, const Eigen::MatrixXd& charges,
                         const Eigen::MatrixXd& carried = {});

 private:
  class Carried;
  /// How a group is refined: in so many steps, of which the first one halves its triangle across a given side
  /// if there is one.
  struct Division {
    int steps = 0;
    std::optional<std::size_t> side = {};
  };
  Eigen::MatrixXd divide(const std::vector<Division>& divisions, const Eigen::MatrixXd& charges,
                         const Eigen::MatrixXd& carried);
  std::vector<Division> cracks() const;
  bool is_kept_closed(std::size_t body) const {
    return std::find(closed_.begin(), closed_.end(), body) != closed_.end();
  }
  void add_group(const std::array<Triangle, 4>& quarters, std::size_t body);
  void add_quartered(const Triangle& triangle, std::size_t body);
  void add_parts(const Triangle& triangle, const Eigen::Matrix3d& places, std::size_t body, int steps,
                 Carried& carried);
  void add_halves(const Triangle& triangle, const Eigen::Matrix3d& places, std::size_t side,
                  const Eigen::Vector3d& middle, std::size_t body, int steps, Carried& carried);
  std::array<Eigen::Vector3d, 3> middles(const Triangle& triangle, std::size_t body) const;
  std::array<double, 3> bends(const Triangle& triangle, const std::array<Eigen::Vector3d, 3>& middles,
                              std::size_t body) const;
  bool is_hidden(const Triangle& triangle, std::size_t body) const {
    return hidden_ != nullptr && hidden_->contains(triangle, body);
  }

  std::shared_ptr<const HiddenSurface> hidden_;
  std::vector<std::optional<RoundShape>> followed_;  ///< of each body
  std::vector<std::size_t> closed_;                  ///< the bodies that are kept closed

  std::vector<Panel> panels_;
  std::vector<PanelGroup> groups_;
  std::vector<Eigen::Index> places_before_;
};

}  // namespace fringe::detail
