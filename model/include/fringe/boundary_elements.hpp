#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/capacitance.hpp"
#include "fringe/scene.hpp"

namespace fringe {

struct BoundaryElementOptions {
  /// The error to be reached, of every entry relative to itself; from 1e-6 to 0.5.
  double rtol = 1e-3;
  /// Where refinement ends: a dense matrix of so many unknowns takes 3 GiB.
  std::size_t most_unknowns = 20'000;
};

/// The Maxwell matrix of a scene's conductors in free space: charge on the row's conductor per volt on the
/// column's, all others grounded or, if floating, without charge.
struct MaxwellMatrix {
  std::vector<std::string> conductors;  ///< the sensors, then the grounded objects
  std::vector<std::string> floating;    ///< objects without a row
  std::size_t sensors = 0;
  Eigen::MatrixXd values;  ///< F
  Eigen::MatrixXd errors;  ///< F, an estimate of each value's error
  /// F, every sensor's own entry less what it is without the objects, and an estimate of its error.
  Eigen::VectorXd delta_self;
  Eigen::VectorXd delta_self_errors;
  /// Whether an entry of the diagonal cannot exceed the truth: Galerkin's charges have the least energy of
  /// all, if the integrals are evaluated much more accurately than the charges are known.
  std::vector<bool> lower_bounds;
  bool reached = false;  ///< whether all estimated errors are within rtol
  std::size_t unknowns = 0;

  /// The positive charge on the grounded conductor per volt on the sensor, −values(sensor, conductor).
  double mutual(std::size_t sensor, std::size_t conductor) const {
    return -values(static_cast<Eigen::Index>(sensor), static_cast<Eigen::Index>(conductor));
  }
};

/// The Maxwell matrix by Galerkin boundary elements (model/BOUNDARY_ELEMENTS.md), refined until the estimated
/// errors are within rtol. Knows every shape in any pose, sensors of several plates, grounded and floating
/// objects. Of a cylinder, cone, arc or sphere the answer is that of its triangles (triangulate()), which lie
/// within it; meshes need not be closed. Throws InputError for dielectric objects, plates that are no
/// rectangles, triangles without area, thinner than 1e-8 or that are there twice, rooms, conductors that
/// touch, cross or are inside each other, more triangles than unknowns, a scene without sensors and objects,
/// and options out of range.
MaxwellMatrix maxwell(const Scene& scene, const BoundaryElementOptions& options = {});

/// What every sensor of the scene feels by its Maxwell matrix: an object's capacitance is `mutual`, a
/// floating object, which takes no charge, is left out, and the voltage is that of the sum, as in the
/// triangle-integral model.
SceneCapacitance capacitance(const Scene& scene, const MaxwellMatrix& matrix);

}  // namespace fringe
