#pragma once

#include <Eigen/Core>

namespace fringe::detail {

/// The Cholesky factorisation A = L·Lᵀ of a symmetric positive definite matrix. In contrast to Eigen's, whose
/// algorithm it is, it can be interrupted: a matrix of 20,000 rows takes minutes.
class Cholesky {
 public:
  Cholesky() = default;
  /// Factorises a matrix, of which the lower triangle is read.
  explicit Cholesky(Eigen::MatrixXd matrix);

  /// Returns false if the matrix is not positive definite; then there is no factor.
  bool is_positive_definite() const { return is_positive_definite_; }

  /// Returns the matrix whose lower triangle is L.
  const Eigen::MatrixXd& factor() const { return factor_; }
  auto lower() const { return factor_.triangularView<Eigen::Lower>(); }
  auto upper() const { return factor_.transpose().triangularView<Eigen::Upper>(); }

  /// Returns L⁻¹·right_side, of many columns; can be interrupted.
  Eigen::MatrixXd solve_lower(Eigen::MatrixXd right_side) const;

  /// Returns A⁻¹·right_side.
  template <typename Derived>
  typename Derived::PlainObject solve(const Eigen::MatrixBase<Derived>& right_side) const {
    typename Derived::PlainObject result = right_side;
    lower().solveInPlace(result);
    upper().solveInPlace(result);
    return result;
  }

 private:
  Eigen::MatrixXd factor_;
  bool is_positive_definite_ = false;
};

}  // namespace fringe::detail
