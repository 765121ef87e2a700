#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include <Eigen/Geometry>

#include "fringe/boundary_elements.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// The steps of the reduction: 1 to 3.
constexpr int most_reduced_steps = 3;

struct ReducedOptions {
  /// How often each body answers the others' charges at least. More are taken where the error asks for it.
  int steps = 2;
  /// The error to be reached, of every entry relative to itself; from 1e-4 to 0.5. None: that of the steps.
  std::optional<double> rtol;
};

/// The error that goes with a number of steps: 1e-2, 1e-3, 3e-4.
double rtol_of(const ReducedOptions& options);

/// Reads "reduced:K", K from 1 to 3; none if the text begins otherwise. Throws InputError for another K.
std::optional<int> parse_reduced_steps(std::string_view text);

/// The Maxwell matrix of rigid bodies, again and again while links move: boundary elements in which every
/// body's charge is sought among very few distributions, found anew for every pose
/// (model/BOUNDARY_ELEMENTS.md, section 8). What does not depend on poses is prepared once.
class ReducedEvaluator {
 public:
  /// Bodies of triangles, round ones among them, are prepared here: a second or two each.
  /// @throws InputError for what maxwell() refuses, but conductors that touch, for bodies of more than 2,000
  /// triangles, and options out of range.
  explicit ReducedEvaluator(const Scene& scene, const ReducedOptions& options = {});
  ~ReducedEvaluator();
  ReducedEvaluator(ReducedEvaluator&&) noexcept;
  ReducedEvaluator& operator=(ReducedEvaluator&&) noexcept;
  ReducedEvaluator(const ReducedEvaluator&) = delete;
  ReducedEvaluator& operator=(const ReducedEvaluator&) = delete;

  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// The answer for the poses as they are; valid until the next call. `unknowns` is the number of
  /// distributions, no entry is called a lower bound, and an error is infinite where nothing is known: of
  /// conductors so close that the quadratures do not see the gap.
  /// @throws InputError for conductors that touch or cross.
  const MaxwellMatrix& maxwell();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The answer of a ReducedEvaluator for a scene as it is.
MaxwellMatrix reduced_capacitance(const Scene& scene, const ReducedOptions& options = {});

}  // namespace fringe
