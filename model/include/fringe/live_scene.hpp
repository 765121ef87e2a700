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

  /// Evaluates every sensor as fringe::evaluate() does; valid until the next call. The counts are the work of
  /// this call. Boundary elements begin anew every time. After an interruption (InterruptionScope) the
  /// preparations of the reduced method are made again.
  const Evaluation& evaluate(const EvaluationOptions& options = {});

  /// Returns the readings in each frame of a motion, as evaluate() finds them; the scene stays in the poses
  /// of the last one. The corrections that know company answer many frames at once, prepared for all of them,
  /// on up to so many threads (0: as many as this process may run at once), with the same bits for any
  /// number; other methods answer one frame after the other.
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
