#pragma once

#include <cstddef>
#include <limits>

#include <Eigen/Core>

#include "fringe/maxwell_matrix.hpp"
#include "readings/readings.hpp"
#include "surface/bodies.hpp"

/// The errors of an answer beside those that were asked for.
namespace fringe::detail {

/// Returns what the errors of the readings' values are relative to; infinity if entries are asked for, whose
/// errors tell more.
Eigen::VectorXd value_scales(const MaxwellMatrix& answer, const ChargedBodies& bodies);

/// Returns what errors are relative to: the entries, or a small part of the geometric mean of the row's and
/// the column's diagonal entries where that is larger; infinity for entries that need not be accurate. Errors
/// of delta_self are left out: delta_self of a distant object vanishes, so that its relative error has no
/// limit.
Eigen::ArrayXXd error_scales(const Eigen::MatrixXd& values, const ChargedBodies& bodies);

/// Returns the largest error of an entry, relative to error_scales(), or of a reading's change, relative to
/// change_scale(), if the scene asks for changes; and of a reading's value if no entries are asked for.
double largest_error(const MaxwellMatrix& answer, const ChargedBodies& bodies);

/// The errors by surfaces that are not those of the bodies.
struct GeometryErrors {
  Eigen::MatrixXd entries;
  ReadingEffects readings;
  bool are_of_facets = false;  ///< of round shapes alone
};

/// Returns the largest error by the surfaces, as largest_error() does of all.
double largest_geometry_error(const MaxwellMatrix& answer, const ChargedBodies& bodies,
                              const GeometryErrors& geometry);

/// Returns the largest error as largest_error() does, but the part that refinement can reduce, relative to
/// what is allowed: the rest of `rtol`, or as much as simplified surfaces have cost already. Where facets
/// cost more than half of `rtol`, which only more segments can reduce, the polyhedron's answer gets all of
/// it.
double excess_error(const MaxwellMatrix& answer, const ChargedBodies& bodies, const GeometryErrors& geometry,
                    double rtol);

/// Tells when refinement goes on in vain.
class Progress {
 public:
  /// Takes the next excess and its number of unknowns; returns true if these are many and the last
  /// refinements hardly reduced the excess.
  bool is_in_vain(double excess, std::size_t unknowns);

 private:
  double best_ = std::numeric_limits<double>::infinity();
  int vain_steps_ = 0;
};

}  // namespace fringe::detail
