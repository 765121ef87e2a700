#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "fringe/capacitance.hpp"
#include "fringe/maxwell_matrix.hpp"
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

/// Computes the Maxwell matrix by the Galerkin boundary element method (model/BOUNDARY_ELEMENTS.md), refined
/// until the estimated errors are within rtol. Supports every shape in any pose, sensors of several plates,
/// grounded and floating objects, electrodes, and conductors of several objects. Round shapes are solved as
/// round, but beside dielectric bodies; an arc with thin walls is represented by its triangles
/// (triangulate()). What the facets cost is in the stated errors. Meshes need not be closed or oriented;
/// their triangles may cross, overlap and be given twice. Grounded objects that touch, overlap or contain
/// each other are one conductor. Dielectric objects are bodies of triangles, too. They may touch and overlap
/// conductors, which displace them, and each other, where the later one fills the common space; no entry is
/// then a lower bound, and refinement ends where the matrices, whose size is the square of the number of
/// panels, take a quarter of the memory. Throws InputError for dielectric objects whose surface is not closed
/// or that are inside a conductor, plates that are not rectangles, meshes without area, rooms, conductors
/// that may have different potentials and touch, cross or are inside each other, more surfaces than unknowns
/// allow, a scene without sensors and objects, and options out of range.
MaxwellMatrix maxwell(const Scene& scene, const BoundaryElementOptions& options = {});

/// Evaluates every sensor of the scene by its Maxwell matrix: an object's capacitance is the charge that it
/// takes, `mutual` if it is a conductor of its own; a floating object, which takes no charge, is omitted; and
/// the voltage is that of the sum, as in the triangle-integral model. `answered_by` is the method that found
/// the matrix.
SceneCapacitance capacitance(const Scene& scene, const MaxwellMatrix& matrix,
                             std::string_view answered_by = "boundary-elements");

}  // namespace fringe
