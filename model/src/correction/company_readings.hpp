#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "correction/company.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"

namespace fringe::detail {

/// The readings of a scene by the formula in company (model/CORRECTIONS.md, section 8), while links move. The
/// machine is prepared when it is first needed, and again when its parts have moved relative to each other;
/// the targets likewise.
class CompanyReadings {
 public:
  /// Prepares nothing yet; the scene's links have the poses given.
  explicit CompanyReadings(std::shared_ptr<LinkPoses> poses);

  /// The name of the formula as a method.
  static constexpr const char* name = "formula in company";

  /// Writes the changes of the readings of a scene of conductors without a room, some of them targets. It
  /// must be the same in every call, except for its poses. The change is infinite where a grounded target
  /// touches what a reading senses or drives; it is not known where contact joins other conductors that may
  /// have different potentials.
  /// @throws InputError for scenes that maxwell() refuses, but for contact with targets.
  void write(const Scene& scene, std::vector<ReadingAnswer>& answers);

 private:
  /// Bodies that keep their poses to each other, in the frame of the first one's link: what is prepared then
  /// does not depend on where they are.
  struct Group {
    ChargedBodies bodies;
    std::vector<Eigen::AlignedBox3d> boxes;  ///< of every body
  };

  void prepare(const Scene& scene);
  bool has_moved(const Group& group) const;
  Eigen::Isometry3d frame(const Group& group) const;
  Group group(const ChargedBodies& bodies, bool of_targets) const;
  /// Where a target touches the machine: the conductors of the machine that it grounds, and whether a contact
  /// joins other potentials.
  struct Contacts {
    std::vector<std::size_t> grounded;
    bool is_unknown = false;
  };
  Contacts contacts(const Eigen::Isometry3d& pose) const;

  LinkMotion motion_;
  std::optional<Group> machine_group_, target_group_;
  std::optional<MachineAtRest> machine_;
  std::optional<TargetAtRest> target_;
  std::vector<ChargedReading> charged_readings_;
  CompanyFormula formula_;
};

}  // namespace fringe::detail
