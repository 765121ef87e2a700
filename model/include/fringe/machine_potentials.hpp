#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"
#include "fringe/surface_charges.hpp"

namespace fringe {

struct MachinePotentialsOptions {
  double rtol = 2e-2;               ///< relative error of the energies at which refinement stops
  std::size_t most_panels = 12000;  ///< refinement stops there, too
  std::size_t functions = 600;      ///< largest number of parts into which the surfaces are divided
  std::size_t threads = 0;          ///< 0: as many as this process may run at once
};

/// A machine at rest as others feel it (model/CORRECTIONS.md, section 8): the potentials of its readings at
/// any points, and how it answers charges there.
class MachinePotentials {
 public:
  /// Solves for the charges of what the scene's readings sense and drive, everything else grounded or
  /// floating without net charge. All objects of the scene belong to the machine.
  /// @throws InputError as surface_charges() does, for options out of range, and for a scene without
  /// readings.
  explicit MachinePotentials(const Scene& scene, const MachinePotentialsOptions& options = {});

  /// A reading by the columns of the potentials of what it senses and of what it drives.
  struct OfReading {
    std::size_t sense;
    std::size_t drive;
    double sign;  ///< of its value when a grounded body comes near
  };
  /// Returns the scene's readings, in their order.
  const std::vector<OfReading>& readings() const;

  /// Returns the largest stated error of the energies of what is sensed, driven or floats, relative to these.
  double error() const;
  /// Returns the number of panels.
  std::size_t panels() const;

  /// Returns the potentials (columns) at points in the world, of 1 V on what is sensed or driven: parts of
  /// the surface that are close count as panels, the others as up to 64 charges.
  TrianglePotentials at(std::span<const Eigen::Vector3d> points, std::size_t threads = 0) const;

  /// Returns charges on the parts of the surface (rows), in √m, by which the machine answers charges about
  /// some places: with v the potentials of a charge on the columns, the machine lowers its energy by v².
  Eigen::MatrixXf answers(std::span<const Eigen::Vector3d> places, std::size_t threads = 0) const;

  /// A conductor by a few points, which stand for it as far away from others as they are.
  struct Body {
    std::vector<Eigen::Vector3d> points;  ///< m, in the body's frame
    /// Symmetric matrix (1/m) that maps charges at the points to potentials with no one else there.
    Eigen::MatrixXd potentials;
  };

  /// The changes of all readings by a body in several poses.
  struct Changes {
    Eigen::MatrixXd values;    ///< m, a row for each pose, to be multiplied by 4πε
    std::vector<bool> clears;  ///< whether the body is apart from the machine; if not, the values are 0
  };
  /// Computes the changes of the readings by a body, by what it and the machine answer to each other.
  /// @param body the body, and the points that stand for it
  /// @param poses from the body's frame to the world
  /// @param answers answers() about such places
  /// @param to_ground capacitance over 4πε through which the body is grounded, in m; connected if not given
  /// @param threads number of threads, 0 for all; the changes have the same bits for any number
  /// @throws InputError for matrices of other sizes.
  Changes changes(const Body& body, std::span<const Eigen::Isometry3d> poses, const Eigen::MatrixXf& answers,
                  std::optional<double> to_ground, std::size_t threads = 0) const;

 private:
  struct Machine;
  std::shared_ptr<const Machine> machine_;
};

}  // namespace fringe
