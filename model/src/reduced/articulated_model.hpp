#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"
#include "geometry/wrench.hpp"
#include "reduced/link_tables.hpp"
#include "reduced/linked_machine.hpp"
#include "reduced/moving_solver.hpp"
#include "reduced/prepared_parts.hpp"
#include "reduced/tabulated_solver.hpp"
#include "surface/target_contacts.hpp"

namespace fringe::detail {

/// Tells whether the stated errors of all changes are within `rtol` of these.
bool are_within(const std::vector<ReadingAnswer>& answers, double rtol);

/// The accuracy for which a machine and its targets are prepared.
struct ModelAccuracy {
  double rtol;            ///< error asked of each change, relative to it
  bool is_rough = false;  ///< prepares with the fewest panels and functions, whatever error is stated then
  bool operator==(const ModelAccuracy&) const = default;
};

/// A scene of conductors as a machine of links and the targets before it, whose readings are found pose by
/// pose (model/CORRECTIONS.md, section 8). What keeps its poses is prepared once, as one link: the whole
/// machine until parts of it have moved against each other, then every part that moves by itself. A machine
/// whose floating conductors have bodies on links that move is prepared again for every pose, as are targets
/// that move against each other.
class ArticulatedModel {
 public:
  /// Prepares nothing yet; the scene's links have the poses given.
  explicit ArticulatedModel(std::shared_ptr<LinkPoses> poses);

  /// Keeps what is prepared in files from now on; null: in none.
  void keep_in(std::shared_ptr<const PreparedFiles> files) { files_ = std::move(files); }

  /// Writes the readings of a scene of conductors without a room, some of them targets. It must be the same
  /// in every call, except for its poses. The change is infinite where a grounded target touches what a
  /// reading senses or drives; it is not known where contact joins other conductors that may have different
  /// potentials.
  /// @throws InputError for scenes that maxwell() refuses, but for contact with targets.
  /// @param with_derivatives whether write_derivatives() follows: bodies on different links are then prepared
  /// each by themselves
  void write(const Scene& scene, std::vector<ReadingAnswer>& answers, const ModelAccuracy& accuracy,
             bool with_derivatives = false);

  /// Writes the derivatives of the changes that write() has just found.
  void write_derivatives(std::vector<ReadingAnswer>& answers);

  /// Returns the readings in so many frames of a motion. The same bits for any number of threads.
  /// @param pose sets the poses of a frame
  std::vector<std::vector<ReadingAnswer>> write_frames(const Scene& scene, std::size_t frames,
                                                       const std::function<void(std::size_t)>& pose,
                                                       const ModelAccuracy& accuracy, std::size_t threads);

 private:
  using AreRigid = std::function<bool(std::optional<std::size_t>, std::optional<std::size_t>)>;
  /// Numbers of bodies that belong together.
  using Members = std::vector<std::size_t>;
  /// Solves poses of a machine of one link, or of several.
  struct Solvers {
    TabulatedSolver at_rest;
    MovingSolver moving;
  };

  static bool keeps(const RigidGroup& group, const LinkMotion& motion);
  bool links_keep(const LinkMotion& motion) const;
  void find_links(const Scene& scene, const AreRigid& are_rigid);
  void find_targets(const Scene& scene);
  RigidGroup group_of(const ChargedBodies& bodies, const Members& members) const;
  void ask(const ModelAccuracy& accuracy);
  void find_pose(PoseOfMachine& pose) const;
  bool is_at_rest() const { return links_.size() == 1; }

  void prepare(const Scene& scene, std::span<const PoseOfMachine> poses, std::size_t threads);
  void prepare_machine(std::span<const PoseOfMachine> poses, std::size_t threads);
  void prepare_targets(std::span<const PoseOfMachine> poses);
  void tabulate(std::span<const PoseOfMachine> poses, std::size_t threads);

  void refuse_contacts_of_links(const PoseOfMachine& pose) const;
  void find_contacts(const PoseOfMachine& pose, std::vector<TargetContacts>& touching) const;
  bool is_shorted(std::size_t reading, const std::vector<TargetContacts>& touching) const;
  bool needs_solution(const std::vector<TargetContacts>& touching) const;
  const std::vector<SolvedReading>& solved(Solvers& solvers, const PoseOfMachine& pose) const;
  void write_pose(Solvers& solvers, const PoseOfMachine& pose, const std::vector<TargetContacts>& touching,
                  std::vector<ReadingAnswer>& answers) const;
  void answer(const Scene& scene, std::span<const PoseOfMachine> poses, std::size_t threads,
              std::span<std::vector<ReadingAnswer>> answers);

  std::shared_ptr<LinkPoses> poses_;
  LinkMotion motion_;  ///< settled when the groups were found
  std::shared_ptr<const PreparedFiles> files_;
  std::vector<RigidGroup> links_;  ///< of the machine
  bool is_divided_ = false;  ///< whether bodies of the machine on different links are in different groups
  std::optional<RigidGroup> targets_;
  std::optional<ModelAccuracy> accuracy_;  ///< for which machine and targets are prepared
  std::unique_ptr<const LinkedMachine> machine_;
  std::string target_input_;  ///< that the targets were prepared from
  std::unique_ptr<const TargetAtRest> target_;
  std::unique_ptr<TabulatedMachine> tabulated_;  ///< a machine of one link
  std::unique_ptr<LinkTables> tables_;           ///< of several links
  std::vector<PoseOfMachine> approach_;          ///< poses that the targets are prepared for
  double prepared_nearness_ = 0;                 ///< largest one in these
  PoseOfMachine pose_;                           ///< of the last answer of write()
  std::vector<TargetContacts> touching_;         ///< in this pose
  std::vector<Eigen::Isometry3d> of_target_;     ///< poses of the targets to a machine of one link
  Solvers solvers_;
  std::vector<Reading> readings_;
  double unit_ = 0;  ///< 4πε, F/m
};

}  // namespace fringe::detail
