#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "fringe/method.hpp"
#include "fringe/reduced_capacitance.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"

namespace fringe::detail {

/// The correction `recommended` for a scene whose links move: uses the reduced method where it determines
/// `mutual` more accurately than the formula does (model/CORRECTIONS.md, section 5).
class RecommendedCorrection {
 public:
  /// A capacitance and the error that is stated of it, in F.
  struct Mutual {
    double value;
    double error;
  };

  /// Prepares a scene, whose links have the poses given. There are no answers if the reduced method refuses
  /// the scene or its meshes would take too long.
  RecommendedCorrection(const Scene& scene, std::shared_ptr<LinkPoses> poses);

  /// Returns the name of the method used.
  static std::string name() { return to_string(Method(Reduced{steps})); }

  /// Computes the answer for the current poses; returns whether any pose was set since the last answer.
  bool update();

  /// Returns the capacitance, or nothing if the formula is to be used.
  std::optional<Mutual> mutual(std::size_t sensor, std::size_t object) const;

 private:
  static constexpr int steps = 1;

  std::shared_ptr<LinkPoses> poses_;
  std::optional<ReducedEvaluator> evaluator_;
  const MaxwellMatrix* matrix_ = nullptr;  ///< null if there is no answer, as when conductors touch
  std::optional<std::uint64_t> answered_;  ///< changes of the poses at the last answer
};

}  // namespace fringe::detail
