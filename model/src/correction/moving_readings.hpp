#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "correction/company.hpp"
#include "correction/moving_formula.hpp"
#include "correction/moving_machine.hpp"
#include "correction/prepared_parts.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"

namespace fringe::detail {

/// The readings, at an accuracy, of a scene the links of whose machine move against each other
/// (model/CORRECTIONS.md, section 8, "Links that move"). Its links are prepared once, each by itself.
class MovingReadings {
 public:
  /// Prepares nothing yet; the scene's links have the poses given.
  explicit MovingReadings(std::shared_ptr<LinkPoses> poses);

  /// Keeps what is prepared in files from now on; null: in none.
  void keep_in(std::shared_ptr<const PreparedFiles> files) { files_ = std::move(files); }

  /// Returns the readings in so many frames of a motion; none if no links of the machine move against each
  /// other, or if the targets do, or if a floating conductor has bodies on links that do. The same bits for
  /// any number of threads.
  /// @param pose sets the poses of a frame
  std::optional<std::vector<std::vector<ReadingAnswer>>>
  write_frames(const Scene& scene, std::size_t frames, const std::function<void(std::size_t)>& pose,
               double rtol, std::size_t threads);

  /// Writes the readings in the present poses. Returns false where write_frames() returns none.
  /// @param may_move whether links of the machine have moved against each other, or are asked what happens if
  /// they do
  bool write(const Scene& scene, std::vector<ReadingAnswer>& answers, double rtol, bool may_move);

  /// Writes the derivatives of the changes that write() has just found.
  void write_derivatives(std::vector<ReadingAnswer>& answers);

 private:
  /// Bodies that keep their poses to each other, in the frame of the first one's link.
  struct Group {
    ChargedBodies bodies;
    std::vector<Eigen::AlignedBox3d> boxes;  ///< of every body
    std::optional<std::size_t> frame;        ///< the link in whose frame they are
  };
  using AreRigid = std::function<bool(std::optional<std::size_t>, std::optional<std::size_t>)>;

  bool find_groups(const Scene& scene, const AreRigid& are_rigid);
  Group group_of(const ChargedBodies& bodies, const std::vector<std::size_t>& members) const;
  bool keeps_groups() const;
  void find_pose();
  void prepare(const Scene& scene, std::span<const PoseOfMachine> poses, double rtol, std::size_t threads);
  void tabulate(std::span<const PoseOfMachine> poses, std::size_t threads);
  void write_pose(MovingFormula& formula, const PoseOfMachine& pose,
                  std::vector<ReadingAnswer>& answers) const;
  void refuse_contacts(const PoseOfMachine& pose) const;

  std::shared_ptr<LinkPoses> poses_;
  std::shared_ptr<const PreparedFiles> files_;
  LinkMotion motion_;  ///< settled when the groups were found
  std::vector<Group> links_;
  std::optional<Group> target_group_;
  std::optional<double> rtol_;  ///< that machine and target are prepared for
  std::optional<MovingMachine> machine_;
  std::optional<LinkTables> tables_;  ///< of the machine's links
  std::optional<TargetAtRest> target_;
  PoseOfMachine pose_;                   ///< the present one
  std::vector<PoseOfMachine> approach_;  ///< poses that the target is prepared for
  double prepared_nearness_ = 0;
  MovingFormula formula_;  ///< with the couplings of the first pose, or of the last one written
  std::vector<Reading> readings_;
  double unit_ = 0;  ///< 4πε, F/m
};

}  // namespace fringe::detail
