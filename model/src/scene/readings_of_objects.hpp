#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "fringe/capacitance.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"
#include "scene/scene_evaluator.hpp"

namespace fringe::detail {

/// Tells for every object whether the triangle-integral methods give it a capacitance. Electrodes and covers
/// have none, nor have floating objects and dielectric targets of a scene that asks for changes; in other
/// scenes these are refused.
std::vector<bool> have_capacitances(const Scene& scene);

/// The readings of a scene by the capacitances of its objects: the change is the sum over the targets, if the
/// reading drives the sensor that it senses and no target floats; value and background are not known, nor is
/// any other change.
class ReadingsOfObjects {
 public:
  explicit ReadingsOfObjects(const Scene& scene);

  /// Writes the readings for an evaluation of the scene.
  void write(const SceneCapacitance& capacitance, std::string_view answered_by,
             std::vector<ReadingAnswer>& answers) const;

  /// Adds the derivatives of the changes with respect to the poses of all links.
  void write_derivatives(SceneEvaluator& evaluator, const LinkPoses& poses,
                         std::vector<ReadingAnswer>& answers) const;

 private:
  struct Change {
    std::string name;
    std::optional<std::size_t> sensor;  ///< none: not known
  };
  std::vector<Change> changes_;
  std::vector<bool> targets_;  ///< for every object
  std::vector<std::optional<std::size_t>> links_of_objects_, links_of_sensors_;
};

}  // namespace fringe::detail
