#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Core>

/// Equations whose matrix is not symmetric.
namespace fringe::detail {

/// Solves A·x = b for every column of `right_sides` by the method of generalised minimal residuals (Saad and
/// Schultz 1986) with a preconditioner on the right. `apply` returns A·x and `precondition` an approximation
/// of A⁻¹·b, both for several columns, so that matrices are read once for all of them. Ends when no column's
/// residual is more than `tolerance` of its right side; returns nothing if `most_steps` do not suffice.
template <class Apply, class Precondition>
std::optional<Eigen::MatrixXd> gmres(const Apply& apply, const Precondition& precondition,
                                     const Eigen::MatrixXd& right_sides, double tolerance, int most_steps) {
  using Eigen::Index;
  using Eigen::MatrixXd;
  using Eigen::VectorXd;
  const Index columns = right_sides.cols();
  const VectorXd sizes = right_sides.colwise().norm();
  MatrixXd direction = right_sides;
  std::vector<MatrixXd> directions, preconditioned;
  /// For every column the triangular factor of the projected matrix, its rotations and right side.
  std::vector<MatrixXd> triangles(static_cast<std::size_t>(columns), MatrixXd::Zero(most_steps, most_steps));
  MatrixXd cosines = MatrixXd::Zero(most_steps, columns), sines = cosines;
  MatrixXd projected = MatrixXd::Zero(most_steps + 1, columns);
  projected.row(0) = sizes.transpose();
  const auto normalise = [&](MatrixXd& vectors, const VectorXd& norms) {
    for (Index c = 0; c < columns; ++c)
      vectors.col(c) *= norms[c] > 0 ? 1 / norms[c] : 0.0;
  };
  normalise(direction, sizes);
  for (Index step = 0; step < most_steps; ++step) {
    directions.push_back(direction);
    preconditioned.push_back(precondition(direction));
    direction = apply(preconditioned.back());
    MatrixXd along(step + 1, columns);
    for (Index k = 0; k <= step; ++k) {
      const MatrixXd& other = directions[static_cast<std::size_t>(k)];
      along.row(k) = direction.cwiseProduct(other).colwise().sum();
      direction -= other * along.row(k).asDiagonal();
    }
    const VectorXd left = direction.colwise().norm();
    normalise(direction, left);
    bool is_enough = true;
    for (Index c = 0; c < columns; ++c) {
      MatrixXd& triangle = triangles[static_cast<std::size_t>(c)];
      for (Index k = 0; k < step; ++k) {
        const double upper = along(k, c), lower = along(k + 1, c);
        along(k, c) = cosines(k, c) * upper + sines(k, c) * lower;
        along(k + 1, c) = cosines(k, c) * lower - sines(k, c) * upper;
      }
      const double radius = std::hypot(along(step, c), left[c]);
      cosines(step, c) = radius > 0 ? along(step, c) / radius : 1;
      sines(step, c) = radius > 0 ? left[c] / radius : 0;
      along(step, c) = radius;
      triangle.col(step).head(step + 1) = along.col(c);
      projected(step + 1, c) = -sines(step, c) * projected(step, c);
      projected(step, c) *= cosines(step, c);
      is_enough &= std::abs(projected(step + 1, c)) <= tolerance * sizes[c];
    }
    if (!is_enough)
      continue;
    MatrixXd result = MatrixXd::Zero(right_sides.rows(), columns);
    for (Index c = 0; c < columns; ++c) {
      // A column that was solved earlier has no further directions.
      const MatrixXd& triangle = triangles[static_cast<std::size_t>(c)];
      VectorXd weights = VectorXd::Zero(step + 1);
      for (Index k = step + 1; k-- > 0;) {
        const double rest = triangle.row(k).segment(k + 1, step - k).dot(weights.tail(step - k));
        weights[k] = triangle(k, k) != 0 ? (projected(k, c) - rest) / triangle(k, k) : 0;
      }
      for (Index k = 0; k <= step; ++k)
        result.col(c) += weights[k] * preconditioned[static_cast<std::size_t>(k)].col(c);
    }
    return result;
  }
  return std::nullopt;
}

}  // namespace fringe::detail
