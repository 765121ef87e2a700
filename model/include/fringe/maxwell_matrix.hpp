#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/reading_answer.hpp"

namespace fringe {

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
  /// Tells which diagonal entries are lower bounds of the true ones. The variational principle of the
  /// Galerkin method makes them so if the integrals are evaluated much more accurately than the charges are
  /// known.
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

}  // namespace fringe
