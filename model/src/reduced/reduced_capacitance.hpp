#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/boundary_elements.hpp"
#include "fringe/method.hpp"
#include "fringe/scene.hpp"

namespace fringe {

namespace detail {
class LinkPoses;
}

/// Which grounded bodies, and bodies of one conductor, may touch, overlap or contain each other.
enum class ReducedContacts {
  refused,
  of_one_link,  ///< bodies on the same link, or in the world
  all,          ///< also bodies on different links, which are prepared again when these move to each other
};

struct ReducedOptions {
  double rtol = 1e-2;  ///< largest error of every entry, relative to the entry; from 1e-4 to 0.5
  ReducedContacts contacts = ReducedContacts::all;
  /// Also finds readings and their changes to this accuracy in a scene that does not ask for changes.
  bool with_changes = false;
};

/// Computes the Maxwell matrix of rigid bodies repeatedly while links move, by a reduced boundary element
/// method: every body's charge is a combination of very few distributions, which are found anew for every
/// pose (model/BOUNDARY_ELEMENTS.md, section 8). What does not depend on poses is prepared once. Bodies in
/// contact at one potential are prepared as one body, as soon as they touch and again whenever they move
/// relative to each other. Dielectric bodies are prepared with the conductor on their link that they touch,
/// as covers with their plates, or by themselves.
class ReducedEvaluator {
 public:
  /// Prepares the scene. Plates and boxes take some milliseconds. A body of triangles, including round ones
  /// and bodies in contact, takes one to two seconds, since few triangles are refined until they are many;
  /// bodies of equal shape are prepared once. What is refused is refused before that.
  ///
  /// @throws InputError for the scenes that maxwell() refuses, except those whose conductors touch, for
  /// bodies of more than 2,500 triangles, alone or together with those they touch, for dielectric bodies that
  /// touch several conductors, or something on another link, and for options out of range.
  explicit ReducedEvaluator(const Scene& scene, const ReducedOptions& options = {});
  /// Prepares the scene for a LiveScene, which owns the poses.
  ReducedEvaluator(const Scene& scene, const ReducedOptions& options,
                   std::shared_ptr<detail::LinkPoses> poses);
  ~ReducedEvaluator();
  ReducedEvaluator(ReducedEvaluator&&) noexcept;
  ReducedEvaluator& operator=(ReducedEvaluator&&) noexcept;
  ReducedEvaluator(const ReducedEvaluator&) = delete;
  ReducedEvaluator& operator=(const ReducedEvaluator&) = delete;

  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Computes the matrix for the current poses; valid until the next call. `unknowns` is the number of
  /// distributions, and no entry is marked as a lower bound. If the scene marks a target or has readings of
  /// its own, `readings` compare with the same basis without the targets, of which most is computed again
  /// only if something else has moved. Where a target touches a body that is none, or nothing is known, they
  /// come from a second solution without the targets; the error of a change is then the sum of those of value
  /// and background. `charges` of a conductor's members add up to its row of `values`; where surfaces of two
  /// members lie on each other, the charge belongs to the earlier one, or to both. An error is infinite where
  /// nothing is known: for conductors so close that the quadratures do not resolve the gap. If asked for, the
  /// readings also have the derivatives of their changes with respect to the poses of all links; they are NaN
  /// where bodies on different links touch. A scene that does not ask for changes is prepared again for them.
  ///
  /// @throws InputError for conductors that touch or cross though they may have different potentials, or
  /// though the options do not allow it, for bodies of more than 2,500 triangles together that touch, and for
  /// dielectric bodies that touch something on another link.
  const MaxwellMatrix& maxwell(bool with_derivatives = false);

 private:
  class Implementation;

  void subtract_background(MaxwellMatrix& matrix, bool with_derivatives);
  void subtract_bare_sensors(MaxwellMatrix& matrix);

  ReducedOptions options_;
  std::shared_ptr<detail::LinkPoses> poses_;
  std::vector<Reading> readings_;  ///< empty if the scene does not ask for changes
  Scene scene_;
  std::unique_ptr<Implementation> implementation_;
  std::unique_ptr<Implementation> background_;  ///< of the scene without the targets, where it is needed
  std::unique_ptr<Implementation> bare_;        ///< of the sensors alone, where covers are prepared with them
};

/// Computes the matrix of a ReducedEvaluator for a scene as it is.
MaxwellMatrix reduced_capacitance(const Scene& scene, const ReducedOptions& options = {});

}  // namespace fringe
