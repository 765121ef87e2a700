#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "fringe/capacitance.hpp"
#include "fringe/scene.hpp"

namespace fringe {

struct BoundaryElementOptions {
  /// Largest error of every entry, relative to the entry; from 1e-6 to 0.5.
  double rtol = 1e-3;
  /// Refinement stops at this number of unknowns: a dense matrix of this size takes 3 GiB.
  std::size_t most_unknowns = 20'000;
};

/// Throws InputError for options that are out of range.
void validate(const BoundaryElementOptions& options);

/// The Maxwell capacitance matrix of a scene's conductors in free space: the charge on the row's conductor
/// per volt on the column's, all others grounded or, if floating, without net charge.
struct MaxwellMatrix {
  std::vector<std::string> conductors;  ///< the sensors, then the grounded objects
  std::vector<std::string> floating;    ///< floating objects, which have no row
  std::size_t sensors = 0;
  Eigen::MatrixXd values;  ///< F
  Eigen::MatrixXd errors;  ///< F, an estimate of the error of each value
  /// F, every sensor's diagonal entry minus its value without the objects, and an estimate of its error.
  Eigen::VectorXd delta_self;
  Eigen::VectorXd delta_self_errors;
  /// Whether a diagonal entry is a lower bound of the true one. It is, by the variational principle of the
  /// Galerkin method, if the integrals are evaluated much more accurately than the charges are known.
  std::vector<bool> lower_bounds;
  bool reached = false;  ///< whether all estimated errors are within rtol
  std::size_t unknowns = 0;

  /// Returns the positive charge on the grounded conductor per volt on the sensor, −values(sensor,
  /// conductor).
  double mutual(std::size_t sensor, std::size_t conductor) const {
    return -values(static_cast<Eigen::Index>(sensor), static_cast<Eigen::Index>(conductor));
  }
};

/// Computes the Maxwell matrix by the Galerkin boundary element method (model/BOUNDARY_ELEMENTS.md), refined
/// until the estimated errors are within rtol. Supports every shape in any pose, sensors of several plates,
/// grounded and floating objects. A cylinder, cone, arc or sphere is represented by its triangles
/// (triangulate()), which lie within it; meshes need not be closed. Throws InputError for dielectric objects,
/// plates that are not rectangles, triangles that have no area, are thinner than 1e-8 or occur twice, rooms,
/// conductors that touch, cross or are inside each other, more triangles than unknowns, a scene without
/// sensors and objects, and options out of range.
MaxwellMatrix maxwell(const Scene& scene, const BoundaryElementOptions& options = {});

/// Evaluates every sensor of the scene by its Maxwell matrix: an object's capacitance is `mutual`; a floating
/// object, which takes no charge, is omitted; and the voltage is that of the sum, as in the triangle-integral
/// model.
///
/// @param answered_by the method that found the matrix
SceneCapacitance capacitance(const Scene& scene, const MaxwellMatrix& matrix,
                             std::string_view answered_by = "boundary-elements");

}  // namespace fringe
