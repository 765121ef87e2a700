#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/evaluation.hpp"
#include "fringe/motion.hpp"
#include "fringe/scene.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_sensing.hpp"

namespace fringe {

/// A scene whose links move, and everything that can be asked of it. It owns the poses; what answers a
/// question is prepared when the question is first asked, and then computes only what has moved since it
/// last answered. Of each kind of question, the preparations for the options asked last are kept.
class LiveScene {
 public:
  explicit LiveScene(Scene scene);
  ~LiveScene();
  LiveScene(LiveScene&&) noexcept;
  LiveScene& operator=(LiveScene&&) noexcept;
  LiveScene(const LiveScene&) = delete;
  LiveScene& operator=(const LiveScene&) = delete;

  /// Returns the scene in its present poses.
  const Scene& scene() const;

  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Replaces the poses of all links relative to their parents, as a frame of a motion holds them. Links that
  /// stay where they are count as not moved.
  /// @throws InputError when there is not one pose for each link.
  void set_poses(const std::vector<Eigen::Isometry3d>& poses);

  /// Moves the link of a joint, and the links of all joints that follow it, to a position in rad or m. Limits
  /// are not checked.
  /// @throws InputError when there is no such joint, when it follows another one, or when the position is not
  /// finite.
  void set_joint(std::string_view joint, double position);

  /// Evaluates every sensor and the readings; valid until the next call. The counts are the work of this
  /// call. Boundary elements begin anew every time. After an interruption (InterruptionScope) what was
  /// prepared is prepared again. Where the reduced method knows no matrix, each object's capacitance is that
  /// of the formula.
  ///
  /// `Auto` answers by the method that is expected to state the accuracy first: the formula or the reduced
  /// method if it is prepared or quickly prepared, else boundary elements; and by the reduced method once
  /// boundary elements have taken as long in other poses as it takes to prepare. If none states the accuracy,
  /// the answer is the one that states the smallest error.
  ///
  /// @throws InputError for scenes that the method refuses, and for options that are out of range, cannot be
  /// combined or belong to another method.
  const Evaluation& evaluate(const EvaluationOptions& options = {});

  /// Returns the readings alone, as evaluate() does; valid until the next call.
  const std::vector<ReadingAnswer>& readings(const EvaluationOptions& options = {});

  /// Returns the parts that the objects add to the sensors, as evaluate() does; valid until the next call.
  const SceneCapacitance& capacitance(const EvaluationOptions& options = {});

  /// Returns the Maxwell matrix, each of its entries within the accuracy asked for if it is reached, by
  /// boundary elements (the default), the reduced method or the cheaper of both; valid until the next call.
  /// @throws InputError for other methods, and as evaluate() does.
  const MaxwellMatrix& maxwell(const EvaluationOptions& options = {});

  /// Returns the readings in each frame of a motion, or in those answered by the end of `max_seconds`; the
  /// scene keeps its present poses. A frame that the method refuses has readings without numbers; if all are,
  /// the first one's InputError is thrown. The reduced method answers many frames at once, prepared for
  /// all of them, on up to so many threads (0: as many as this process may run at once), with the same bits
  /// for any number; others answer one frame after the other.
  std::vector<std::vector<ReadingAnswer>> readings_of(const std::vector<Frame>& motion,
                                                      const EvaluationOptions& options = {},
                                                      std::size_t threads = 0);

  /// Finds the objects that collide, as fringe::collide() does; valid until the next call.
  const SceneCollision& collide();

  /// Evaluates the distance sensors, as fringe::sense() does.
  std::vector<DistanceReading> sense(ConeMethod method = ConeMethod::field_of_view);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fringe
