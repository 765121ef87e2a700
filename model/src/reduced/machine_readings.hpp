#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"
#include "reduced/articulated_model.hpp"

namespace fringe::detail {

/// Tells for every object whether its share of a change is enclosed: of targets that are dielectric, with at
/// least the medium's permittivity, in a scene that asks for changes.
std::vector<bool> are_enclosed(const Scene& scene);

/// The readings before a machine of scenes that may have covers and dielectric targets, while
/// links move (model/CORRECTIONS.md, section 9). Covers follow the layer rule. More permittivity anywhere
/// raises the energy at given potentials, so that the change lies between those without the dielectric
/// targets and with conductors in their place: floating ones, or grounded ones where these touch others. The
/// error states that.
class MachineReadings {
 public:
  /// Prepares nothing yet; the scene's links have the poses given.
  explicit MachineReadings(std::shared_ptr<LinkPoses> poses);

  /// Tells whether the readings of a scene can be found: it has some and targets, has no room, and of
  /// dielectric objects only covers and targets that are enclosed.
  static bool knows(const Scene& scene);

  /// Keeps what is prepared in files from now on; null: in none.
  void keep_in(std::shared_ptr<const PreparedFiles> files) { files_ = std::move(files); }

  /// Writes the readings of a scene, as ArticulatedModel does. Beside dielectric objects only changes are
  /// known.
  void write(const Scene& scene, std::vector<ReadingAnswer>& answers, const ModelAccuracy& accuracy,
             bool with_derivatives = false);

  /// Writes the derivatives of the changes that write() has just found; none beside dielectric targets.
  void write_derivatives(std::vector<ReadingAnswer>& answers);

  /// Returns the readings in so many frames of a motion, as ArticulatedModel does.
  std::vector<std::vector<ReadingAnswer>> write_frames(const Scene& scene, std::size_t frames,
                                                       const std::function<void(std::size_t)>& pose,
                                                       const ModelAccuracy& accuracy, std::size_t threads);

 private:
  /// A scene of conductors only, and what answers it.
  struct Conducting {
    Scene scene;
    ArticulatedModel model;
  };

  void prepare(const Scene& scene);
  void enclose(std::vector<ReadingAnswer>& answers, const ModelAccuracy& accuracy);

  std::shared_ptr<LinkPoses> poses_;
  std::optional<Conducting> upper_;     ///< conductors in the place of dielectric targets; else all there is
  std::optional<Conducting> grounded_;  ///< with grounded ones where `upper_` has floating ones
  std::optional<Conducting> lower_;     ///< without dielectric targets, if there are others, too
  std::shared_ptr<const PreparedFiles> files_;
  bool has_insulators_ = false, has_covers_ = false;
  /// Estimated share that dielectric targets have of the change by conductors; none: there are none of them.
  std::optional<double> share_;
  std::vector<bool> drive_themselves_;  ///< for every reading, whether it drives what it senses only
};

}  // namespace fringe::detail
