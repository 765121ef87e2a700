#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "correction/charge_functions.hpp"
#include "fringe/scene.hpp"

/// The formula that knows company: what targets change in the readings of a machine at rest
/// (model/CORRECTIONS.md, section 8).
namespace fringe::detail {

/// How finely conductors are prepared.
struct CompanyResolution {
  double rtol;              ///< stated error at which the refinement of their charges ends
  std::size_t most_panels;  ///< refinement ends there, too
  std::size_t functions;    ///< largest number of parts of their surfaces
  std::size_t least_panels = 0;
  std::size_t threads = 1;    ///< 0: as many as this process may run at once
  bool is_estimated = false;  ///< whether what the panels lack is given as charges of its own

  /// Describes what the charges depend on: they are the same for any number of threads.
  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.rtol, self.most_panels, self.functions, self.least_panels, self.is_estimated);
  }
};

/// Charges in the sums of neighbouring functions: the defect of a charge is the energy that these lack.
class CoarseCharges {
 public:
  /// Prepares nothing, for an archive that has the sums.
  CoarseCharges() = default;
  /// Prepares the sums, without net charge on conductors that float: `net` has the charges of the functions
  /// on each of these.
  CoarseCharges(const ChargeFunctions& functions, const Eigen::MatrixXd& net,
                const Eigen::VectorXd& to_ground);
  /// Returns how much less energy, of given potentials, the sums take than the charges (columns) that are the
  /// functions' own answer to them.
  Eigen::MatrixXd defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials) const;

  /// Arrays for defects of the same numbers of charges, one after the other.
  struct Workspace {
    Eigen::MatrixXf sums, answers, energies, of_sums;
    Eigen::MatrixXd defects;
  };
  /// Finds the same in a workspace, without allocating memory once that has the sizes.
  void find_defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials,
                    Workspace& workspace) const;

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.functions_, self.inverse_);
  }

 private:
  CoarseFunctions functions_;
  Eigen::MatrixXf inverse_;
};

/// Returns the aligned box around a moved one.
Eigen::AlignedBox3d moved_box(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& pose);

/// A box around a body, along the sides of its first triangle.
struct PlacedBox {
  Eigen::Isometry3d to_box;  ///< to the frame in which the box is aligned
  Eigen::AlignedBox3d box;

  double distance(const Eigen::Vector3d& point) const { return box.exteriorDistance(to_box * point); }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.to_box, self.box);
  }
};

/// What does not change while targets move: the charges of the readings' conductors, and how the machine
/// answers to charges outside it.
class MachineAtRest {
 public:
  /// Prepares nothing, for an archive that has the machine.
  MachineAtRest() = default;
  /// Prepares the conductors of a machine, in world coordinates, for readings of them.
  /// @throws InputError for a reading of what is neither a sensor nor an electrode.
  MachineAtRest(ChargedBodies bodies, const std::vector<Reading>& readings,
                const CompanyResolution& resolution);

  /// A reading by the places of what it senses and drives among the given charges of the functions.
  struct OfReading {
    Eigen::Index sense;
    Eigen::Index drive;
    double sign;

    template <typename Archive, typename Self>
    static void describe(Archive& archive, Self& self) {
      archive(self.sense, self.drive, self.sign);
    }
  };

  /// The value of a reading without targets and its error in m, to be multiplied by 4πε.
  struct Background {
    double value;
    double error;

    template <typename Archive, typename Self>
    static void describe(Archive& archive, Self& self) {
      archive(self.value, self.error);
    }
  };

  const ChargeFunctions& functions() const { return functions_; }
  const std::vector<OfReading>& readings() const { return readings_; }
  const std::vector<Background>& backgrounds() const { return backgrounds_; }
  /// Returns boxes around the bodies that are sensed or driven.
  const std::vector<PlacedBox>& used() const { return used_; }
  Eigen::Index loads() const { return loads_; }
  /// Returns the number of charges that the functions are given: those of the loads and, if it is estimated,
  /// what these lack with one density on each group of panels.
  Eigen::Index given() const { return functions_.points(0).given.cols(); }
  /// Returns the charges of the functions by their potentials, floating conductors without net charge: a
  /// symmetric matrix in whole blocks.
  const std::vector<float>& answers() const { return answers_; }
  const CoarseCharges& coarse() const { return coarse_; }
  /// Returns the largest stated error of the energies of what is sensed, driven or floats, relative to these.
  double error() const { return error_; }
  /// Returns the ratio of that error to the one asked for: more than 1 where the panels did not suffice.
  double excess() const { return excess_; }

  /// Resolution of the formula, 0.1 to 1 s to prepare.
  static constexpr CompanyResolution usual{3e-2, 6000, 200, 0, 1, true};

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.readings_, self.backgrounds_, self.loads_, self.used_, self.error_, self.excess_,
            self.functions_, self.coarse_, self.answers_);
  }

 private:
  MachineAtRest(const ConductorsAtRest& conductors, const std::vector<Reading>& readings,
                const CompanyResolution& resolution);

  void find_backgrounds(const ConductorsAtRest& conductors, const std::vector<ChargedReading>& charged);

  std::vector<OfReading> readings_;
  std::vector<Background> backgrounds_;
  Eigen::Index loads_ = 0;
  std::vector<PlacedBox> used_;
  double error_ = 0;
  double excess_ = 0;
  ChargeFunctions functions_;
  CoarseCharges coarse_;
  std::vector<float> answers_;
};

/// Where targets come near what is sensed or driven.
struct Approach {
  std::vector<PlacedBox> boxes;          ///< around what is sensed or driven, in the frame of the machine
  std::vector<Eigen::Isometry3d> poses;  ///< from the frame of the targets to that of the machine

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.boxes, self.poses);
  }

  /// Returns the size of a part of a target relative to its distance, the largest one in the poses.
  double relative_size(const Eigen::AlignedBox3d& part) const;
};

/// The targets, which keep their poses to each other.
class TargetAtRest {
 public:
  /// Prepares nothing, for an archive that has the targets.
  TargetAtRest() = default;
  /// Prepares the targets, finer where they come near if an approach is known.
  TargetAtRest(ChargedBodies bodies, const CompanyResolution& resolution,
               const std::optional<Approach>& approach = {});

  const ChargeFunctions& functions() const { return functions_; }
  Eigen::Index conductors() const { return equilibrium_.cols(); }
  /// Returns the charges of the functions by their potentials with no one else there, in whole blocks.
  const std::vector<float>& inverse() const { return inverse_; }
  /// Returns the charges of the functions (rows) for each conductor at unit potential, the others grounded.
  const Eigen::MatrixXd& equilibrium() const { return equilibrium_; }
  /// Returns the Maxwell matrix of the targets by themselves, in m.
  const Eigen::MatrixXd& own() const { return own_; }
  /// Returns the net charges of the functions on each conductor.
  const Eigen::MatrixXd& net() const { return net_; }
  /// Returns the numbers of the conductors that are not grounded, and their capacitances to the ground in m.
  const std::vector<Eigen::Index>& floating() const { return floating_; }
  const Eigen::VectorXd& to_ground() const { return to_ground_; }
  const CoarseCharges& coarse() const { return coarse_; }
  /// Returns the distance of a function's part of the surface from a box of the machine.
  ///
  /// @param pose from the frame of the targets to that of the box
  double distance(std::size_t function, const PlacedBox& box, const Eigen::Isometry3d& pose) const;
  /// Returns the error of a change by the panels: the stated one of the targets' own charges, which counts
  /// all parts of them. Where this exceeds what was asked for, it is limited by what half as many functions
  /// lose of the change, which is more than what the panels lose: a function has several of them.
  double error_of_panels(double change, double of_functions) const {
    return std::min(error_ * std::abs(change), std::max(rtol_ * std::abs(change), of_functions));
  }

  /// Resolution of the formula, 0.1 to 1 s to prepare.
  static constexpr CompanyResolution usual{2e-2, 2500, 128};

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.functions_, self.parts_, self.coarse_, self.inverse_, self.net_, self.equilibrium_,
            self.own_, self.floating_, self.to_ground_, self.rtol_, self.error_);
  }

 private:
  TargetAtRest(const ConductorsAtRest& conductors, const CompanyResolution& resolution,
               const std::optional<Approach>& approach);

  ChargeFunctions functions_;
  std::vector<PlacedBox> parts_;  ///< around the part of every function
  CoarseCharges coarse_;
  std::vector<float> inverse_;
  Eigen::MatrixXd net_;
  Eigen::MatrixXd equilibrium_;
  Eigen::MatrixXd own_;
  std::vector<Eigen::Index> floating_;
  Eigen::VectorXd to_ground_;
  double rtol_ = 0;  ///< asked for
  double error_ = 0;
};

/// Returns the error of a change by the facets of round bodies: that of the energy of the target's charges,
/// and the relative one of the given charges, once for the sensed and once for the driven conductor.
double facet_effect(double of_given, const TargetAtRest& target, double change,
                    const Eigen::Ref<const Eigen::VectorXf>& sensed,
                    const Eigen::Ref<const Eigen::VectorXf>& driven);

/// Evaluates what targets change, pose by pose.
class CompanyFormula {
 public:
  /// A change and what is stated of its error, in m; infinite: the error is not known.
  struct Change {
    double value;
    double error;
  };

  /// Returns the change of every reading in m, to be multiplied by 4πε; valid until the next call.
  ///
  /// @param pose from the frame of the targets to that of the machine
  const std::vector<Change>& changes(const MachineAtRest& machine, const TargetAtRest& target,
                                     const Eigen::Isometry3d& pose);

  /// Returns the largest ratio, in a pose, of the radius of a function of the target to its distance from
  /// what is sensed or driven: gaps below it are not resolved.
  static double nearness(const MachineAtRest& machine, const TargetAtRest& target,
                         const Eigen::Isometry3d& pose);

 private:
  /// Points of functions, in the frame of the machine.
  struct Points {
    std::vector<std::size_t> levels;  ///< of every function
    std::vector<float> x, y, z, shares, charges, potentials;
    std::size_t count = 0;
  };

  /// What the target is charged with for a reading: the directions that count, and their coefficients if the
  /// sensed and if the driven conductors have the voltage.
  struct Charged {
    std::vector<Eigen::Index> directions;
    Eigen::VectorXd sensed, driven;
  };

  void place(const MachineAtRest& machine, const TargetAtRest& target, const Eigen::Isometry3d& pose);
  void place_target(const MachineAtRest& machine, const TargetAtRest& target, const Eigen::Isometry3d& pose);
  void place_machine(const MachineAtRest& machine, const TargetAtRest& target, const Eigen::Isometry3d& pose);
  void find_potentials(const MachineAtRest& machine, const TargetAtRest& target);
  void find_answers(const MachineAtRest& machine, const TargetAtRest& target);
  void combine(const MachineAtRest& machine, const TargetAtRest& target);
  double missing_energy(const TargetAtRest& target, Eigen::Index load, const Eigen::VectorXf& own,
                        const Eigen::VectorXf& answer);
  double error(const MachineAtRest& machine, const TargetAtRest& target,
               const MachineAtRest::OfReading& reading, const Charged& charged, double change);
  static void gather(const Points& points, const ChargeFunctions& functions, float* of_functions);
  static void spread(const ChargeFunctions& functions, const float* of_functions, Points& points);

  Points target_, machine_;
  const ChargeFunctions* of_machine_ = nullptr;
  std::vector<std::vector<float>> given_;       ///< the machine's given charges at its points
  std::vector<float> distances_;                ///< 1/r of the target's points (rows) and the machine's
  std::vector<std::vector<float>> by_given_;    ///< potentials of the given charges on the target's functions
  std::vector<std::vector<float>> charges_;     ///< the charges of the target's functions in each direction
  std::vector<std::vector<float>> on_machine_;  ///< their potentials on the machine's functions
  Eigen::MatrixXf own_;      ///< potentials of each direction (columns) on the target's functions by itself
  Eigen::MatrixXf answers_;  ///< charges by which the machine's functions answer each direction (columns)
  Eigen::MatrixXf lacking_;  ///< potentials of what the given charges lack on the target's functions
  Eigen::VectorXd unresolved_;  ///< potentials on the target that the points of the given charges may lack
  Eigen::MatrixXd form_;        ///< energies of the directions before the machine
  Eigen::MatrixXd potentials_;  ///< of the given charges (columns) by direction
  Eigen::MatrixXd net_;         ///< net charges of the directions on each target conductor (columns)
  double nearness_ = 0;
  CoarseCharges::Workspace of_target_, of_answers_;
  std::vector<Change> changes_;
};

}  // namespace fringe::detail
