#pragma once

#include <Eigen/Core>

#include "bem/hierarchical_matrix.hpp"

namespace fringe::detail {

/// A symmetric matrix of a few functions, given by all their elements, and of many unknowns with a
/// hierarchical matrix. Vectors have the functions first, then the unknowns in the order of the tree.
struct BorderedMatrix {
  Eigen::MatrixXd functions;  ///< of the functions with each other
  Eigen::MatrixXf coupling;   ///< of the functions (rows) with the unknowns; rounded like the unknowns' own
  const HierarchicalMatrix& unknowns;
  /// Zero for functions and unknowns that are left out, else one; without elements, all are present.
  Eigen::VectorXd present;

  Eigen::Index size() const { return functions.rows() + unknowns.size(); }

  /// Returns the product with vectors, the columns of `factors`; zero in rows that are left out.
  Eigen::MatrixXd apply(const Eigen::MatrixXd& factors) const;
};

}  // namespace fringe::detail
