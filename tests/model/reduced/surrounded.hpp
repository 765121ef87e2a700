#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fringe/motion.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene.hpp"
#include "reduced/machine_readings.hpp"

namespace fringe::test {

/// The readings of a scene whose links move, before a machine that is prepared roughly or for an accuracy.
class Surrounded {
 public:
  explicit Surrounded(Scene scene)
      : scene_(std::move(scene)), poses_(std::make_shared<detail::LinkPoses>(scene_.links)),
        readings_(poses_) {}

  const Scene& scene() const { return scene_; }

  void set_pose(const std::string& link, const Eigen::Isometry3d& pose) {
    poses_->set_pose(link, pose);
    fringe::set_pose(scene_, link, pose);
  }

  void set_poses(const std::vector<Eigen::Isometry3d>& poses) {
    for (std::size_t k = 0; k < poses.size(); ++k)
      if (scene_.links[k].pose.matrix() != poses[k].matrix())
        set_pose(scene_.links[k].name, poses[k]);
  }

  void keep_in(std::shared_ptr<const detail::PreparedFiles> files) { readings_.keep_in(std::move(files)); }

  /// Returns the answers in the present poses; valid until the next call.
  const std::vector<ReadingAnswer>& answers(std::optional<double> rtol = {}, bool with_derivatives = false) {
    readings_.write(scene_, answers_, accuracy(rtol), with_derivatives);
    if (with_derivatives)
      readings_.write_derivatives(answers_);
    return answers_;
  }

  std::vector<std::vector<ReadingAnswer>> answers_of(const std::vector<Frame>& motion,
                                                     std::optional<double> rtol, std::size_t threads) {
    return readings_.write_frames(
        scene_, motion.size(), [&](std::size_t frame) { set_poses(motion[frame].poses); }, accuracy(rtol),
        threads);
  }

 private:
  /// Without an rtol everything is prepared roughly.
  static detail::ModelAccuracy accuracy(std::optional<double> rtol) {
    return {rtol.value_or(0.1), !rtol.has_value()};
  }

  Scene scene_;
  std::shared_ptr<detail::LinkPoses> poses_;
  detail::MachineReadings readings_;
  std::vector<ReadingAnswer> answers_;
};

inline std::vector<double> changes_and_errors(const std::vector<std::vector<ReadingAnswer>>& answers) {
  std::vector<double> found;
  for (const std::vector<ReadingAnswer>& frame : answers)
    for (const ReadingAnswer& reading : frame) {
      found.push_back(reading.change.value.value());
      found.push_back(reading.change.error.value());
    }
  return found;
}

}  // namespace fringe::test
