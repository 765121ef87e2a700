#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "fringe/capacitance.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// What of a Maxwell matrix is refined until its errors are as small as asked.
enum class Entries {
  all,
  of_sensors,  ///< in rows of sensors and electrodes, where targets are marked only those with each other and
               ///< with targets; all where there are no sensors and electrodes
  of_readings  ///< no entry for itself, but the readings and their changes; all where there are no sensors
               ///< and electrodes
};

/// A solution that is not accurate enough.
struct RefinementLevel {
  std::size_t unknowns;
  double error;  ///< the largest of what is asked for, in the same measure as rtol
};

struct BoundaryElementOptions {
  /// Largest error of the entries asked for, relative to the entry or to 1e-3 of the geometric mean of its
  /// row's and its column's diagonal entries, whichever is larger; from 1e-6 to 0.5.
  double rtol = 1e-2;
  Entries entries = Entries::all;
  /// Refinement stops at this number of unknowns, or where the matrix would take a quarter of the memory.
  std::size_t most_unknowns = 1'000'000;
  /// Also finds the derivatives of the readings' changes with respect to the poses of the links.
  bool derivatives = false;
  /// Number of threads; 0: as many as this process may run at once. The answer does not depend on it.
  std::size_t threads = 0;
  /// Is called before each refinement; may be empty.
  std::function<void(const RefinementLevel&)> before_refinement = {};
};

/// Throws InputError for options that are out of range.
void validate(const BoundaryElementOptions& options);

/// The Maxwell capacitance matrix of a scene's conductors in free space: the charge on the row's conductor
/// per volt on the column's, all others grounded or, if floating, without net charge.
struct MaxwellMatrix {
  /// The sensors, then grounded conductors and electrodes in the order of the scene. Objects of one
  /// `conductor` are one, and so are grounded objects that touch or overlap: it has the first name that an
  /// object gives it, else that of its first object.
  std::vector<std::string> conductors;
  std::vector<std::vector<std::string>> members;  ///< of each conductor: the sensor, or its objects
  std::vector<std::string> floating;              ///< floating objects, which have no row
  std::size_t sensors = 0;
  Eigen::MatrixXd values;  ///< F
  /// F, the charge on each member (rows: those of the first conductor, then of the second …) per volt on each
  /// conductor. The rows of a conductor's members add up to its row of `values`, within its error.
  Eigen::MatrixXd charges;
  Eigen::MatrixXd errors;  ///< F, an estimate of the error of each value
  /// F, every sensor's diagonal entry minus its value without the objects, and an estimate of its error.
  Eigen::VectorXd delta_self;
  Eigen::VectorXd delta_self_errors;
  /// Whether a diagonal entry is a lower bound of the true one. It is, by the variational principle of the
  /// Galerkin method, if the integrals are evaluated much more accurately than the charges are known.
  std::vector<bool> lower_bounds;
  /// The answers of the readings. `lower` is given where the value is a lower bound, as for `lower_bounds`.
  std::vector<ReadingAnswer> readings;
  /// True if the estimated errors of the entries asked for are within rtol; and those of the readings'
  /// changes, if the scene asks for them: it has readings of its own, marks a target, or has electrodes.
  bool reached = false;
  std::size_t unknowns = 0;

  /// Returns the conductor of an object, given by its place among the members of all grounded conductors.
  std::size_t conductor_of(std::size_t object) const {
    std::size_t conductor = sensors;
    for (; object >= members[conductor].size(); ++conductor)
      object -= members[conductor].size();
    return conductor;
  }

  /// Returns the positive charge on the grounded conductor per volt on the sensor, −values(sensor,
  /// conductor).
  double mutual(std::size_t sensor, std::size_t conductor) const {
    return -values(static_cast<Eigen::Index>(sensor), static_cast<Eigen::Index>(conductor));
  }
};

/// Computes the Maxwell matrix by the Galerkin boundary element method (model/BOUNDARY_ELEMENTS.md), refined
/// until the estimated errors are within rtol. Supports every shape in any pose, sensors of several plates,
/// grounded and floating objects, electrodes, and conductors of several objects. A sphere, ellipsoid,
/// capsule, disc or cuboid with rounded edges is solved as round; a cylinder, cone or arc is represented by
/// its triangles (triangulate()), whose effect is in the stated errors. Meshes need not be closed or
/// oriented; their triangles may cross, overlap and be given twice. Grounded objects that touch, overlap or
/// contain each other are one conductor. Dielectric objects are bodies of triangles, too. They may touch and
/// overlap conductors, which displace them, and each other, where the later one fills the common space; no
/// entry is then a lower bound, and refinement ends at 9,000 panels. Throws InputError for dielectric objects
/// whose surface is not closed or that are inside a conductor, plates that are not rectangles, meshes without
/// area, rooms, conductors that may have different potentials and touch, cross or are inside each other, more
/// surfaces than unknowns allow, a scene without sensors and objects, and options out of range.
MaxwellMatrix maxwell(const Scene& scene, const BoundaryElementOptions& options = {});

/// Evaluates every sensor of the scene by its Maxwell matrix: an object's capacitance is the charge that it
/// takes, `mutual` if it is a conductor of its own; a floating object, which takes no charge, is omitted; and
/// the voltage is that of the sum, as in the triangle-integral model. `answered_by` is the method that found
/// the matrix.
SceneCapacitance capacitance(const Scene& scene, const MaxwellMatrix& matrix,
                             std::string_view answered_by = "boundary-elements");

}  // namespace fringe
