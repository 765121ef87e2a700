#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "correction/company.hpp"
#include "correction/moving_readings.hpp"
#include "correction/prepared_parts.hpp"
#include "correction/tabulated_formula.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"

namespace fringe::detail {

struct TargetContacts;

/// Tells whether the stated errors of all changes are within `rtol` of these.
bool are_within(const std::vector<ReadingAnswer>& answers, double rtol);

/// The readings of a scene with surrounding conductors (model/CORRECTIONS.md, section 8), while links move.
/// The machine is prepared when it is first needed, and again when its parts have moved relative to each
/// other; the targets likewise.
class CompanyReadings {
 public:
  /// Prepares nothing yet; the scene's links have the poses given.
  explicit CompanyReadings(std::shared_ptr<LinkPoses> poses);

  /// Keeps what is prepared for an accuracy in files from now on; null: in none.
  void keep_in(const std::shared_ptr<const PreparedFiles>& files) {
    files_ = files;
    moving_.keep_in(files);
  }

  /// Writes the changes of the readings of a scene of conductors without a room, some of them targets. It
  /// must be the same in every call, except for its poses. The change is infinite where a grounded target
  /// touches what a reading senses or drives; it is not known where contact joins other conductors that may
  /// have different potentials.
  /// @throws InputError for scenes that maxwell() refuses, but for contact with targets.
  /// @param rtol the error asked of the changes, relative; without it the formula in closed form answers
  /// @param with_derivatives whether write_derivatives() follows: the machine's links are then prepared each
  /// by itself
  void write(const Scene& scene, std::vector<ReadingAnswer>& answers, std::optional<double> rtol = {},
             bool with_derivatives = false);

  /// Writes the derivatives of the changes that write() has just found at an accuracy.
  void write_derivatives(std::vector<ReadingAnswer>& answers);

  /// Returns the readings in so many frames of a motion. The same bits for any number of threads.
  /// @param pose sets the poses of a frame
  std::vector<std::vector<ReadingAnswer>> write_frames(const Scene& scene, std::size_t frames,
                                                       const std::function<void(std::size_t)>& pose,
                                                       std::optional<double> rtol, std::size_t threads);

 private:
  /// Bodies that keep their poses to each other, in the frame of the first one's link: what is prepared then
  /// does not depend on where they are.
  struct Group {
    ChargedBodies bodies;
    std::vector<Eigen::AlignedBox3d> boxes;  ///< of every body
  };

  /// Ends the preparations of what an accuracy or moved links make useless.
  void update(std::optional<double> rtol);
  void find_groups(const Scene& scene);
  /// Prepares what is not prepared; the target for an approach in these poses if it is not.
  void prepare(const Scene& scene, const std::vector<Eigen::Isometry3d>& poses, std::size_t threads);
  /// Tabulates the machine where the target is in some poses, if an accuracy is asked for.
  void tabulate(std::span<const Eigen::Isometry3d> poses, std::size_t threads);
  Eigen::Isometry3d target_pose() const {
    return frame(*machine_group_).inverse(Eigen::Isometry) * frame(*target_group_);
  }
  /// Finds where the targets touch the machine in a pose.
  TargetContacts contacts(const Eigen::Isometry3d& pose) const;
  /// Tells whether contact grounds what a reading senses or drives.
  static bool is_shorted(const ChargedReading& reading, const TargetContacts& touching);
  /// Tells whether contact leaves a change to be computed.
  bool needs_formula(const TargetContacts& touching) const;
  /// @param tabulated the formula with the tabulated machine; null: `formula` answers
  void write_pose(CompanyFormula& formula, TabulatedFormula* tabulated, const Eigen::Isometry3d& pose,
                  const TargetContacts& touching, std::vector<ReadingAnswer>& answers) const;
  /// Returns the files to keep preparations in: of those for an accuracy, which take long.
  const PreparedFiles* files() const { return rtol_ ? files_.get() : nullptr; }
  bool has_moved(const Group& group) const;
  Eigen::Isometry3d frame(const Group& group) const;
  Group group(const ChargedBodies& bodies, bool of_targets) const;

  std::shared_ptr<LinkPoses> poses_;
  LinkMotion motion_;
  std::optional<Group> machine_group_, target_group_;
  std::shared_ptr<const PreparedFiles> files_;
  std::optional<double> rtol_;                ///< that machine and target are prepared for
  std::string machine_input_, target_input_;  ///< that they were prepared from
  std::unique_ptr<const MachineAtRest> machine_;
  std::optional<TargetAtRest> target_;
  std::unique_ptr<TabulatedMachine> tabulated_;  ///< for an accuracy
  std::vector<Eigen::Isometry3d> approach_;      ///< poses that the target is prepared for
  double prepared_nearness_ = 0;                 ///< largest one in these
  std::vector<ChargedReading> charged_readings_;
  double unit_ = 0;  ///< 4πε, F/m
  CompanyFormula formula_;
  TabulatedFormula tabulated_formula_;
  bool is_by_links_ = false;  ///< the last answer: by links that may move
  MovingReadings moving_;     ///< once links of the machine move against each other
};

}  // namespace fringe::detail
