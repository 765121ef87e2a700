#pragma once

#include <cstddef>
#include <utility>

#include <Eigen/Core>

namespace fringe::detail {

/// The Cholesky factorisation A = L·Lᵀ of a symmetric positive definite matrix. In contrast to Eigen's it can
/// be interrupted, uses the widest registers of the processor and several threads; the result does not depend
/// on their number.
class Cholesky {
 public:
  Cholesky() = default;
  /// Factorises a matrix, of which the lower triangle is read. `threads` is the number for this and for
  /// solving; 0: all.
  explicit Cholesky(Eigen::MatrixXd matrix, std::size_t threads = 1);

  /// Returns false if the matrix is not positive definite; then there is no factor.
  bool is_positive_definite() const { return is_positive_definite_; }

  /// Returns the matrix whose lower triangle is L.
  const Eigen::MatrixXd& factor() const { return factor_; }

  /// Returns L⁻¹·right_sides.
  Eigen::MatrixXd solve_lower(Eigen::MatrixXd right_sides) const;

  /// Returns L⁻ᵀ·right_sides.
  Eigen::MatrixXd solve_upper(Eigen::MatrixXd right_sides) const;

  /// Returns A⁻¹·right_sides.
  Eigen::MatrixXd solve(Eigen::MatrixXd right_sides) const {
    return solve_upper(solve_lower(std::move(right_sides)));
  }

 private:
  bool factorise(Eigen::Index first, Eigen::Index count);
  void subtract_products(Eigen::Index first, Eigen::Index count, Eigen::Index columns);

  Eigen::MatrixXd factor_;
  std::size_t threads_ = 1;
  bool is_positive_definite_ = false;
};

}  // namespace fringe::detail
