#pragma once

#include <Eigen/Core>

/// Products of matrices in memory, stored by columns, with several vectors. Eigen's use the instructions that
/// every processor of x86-64 has; these the widest registers of this one.
namespace fringe::detail {

template <class Number>
using MatrixReference = Eigen::Ref<const Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>>;

/// Adds matrix·factors to the sums.
void add_product(const MatrixReference<double>& matrix, const MatrixReference<double>& factors,
                 Eigen::Ref<Eigen::MatrixXd> sums);
/// Adds matrix·factors to the sums, for a matrix in single precision.
void add_product(const MatrixReference<float>& matrix, const MatrixReference<double>& factors,
                 Eigen::Ref<Eigen::MatrixXd> sums);

/// Adds matrixᵀ·factors to the sums.
void add_transposed_product(const MatrixReference<double>& matrix, const MatrixReference<double>& factors,
                            Eigen::Ref<Eigen::MatrixXd> sums);
/// Adds matrixᵀ·factors to the sums, for a matrix in single precision.
void add_transposed_product(const MatrixReference<float>& matrix, const MatrixReference<double>& factors,
                            Eigen::Ref<Eigen::MatrixXd> sums);

}  // namespace fringe::detail
