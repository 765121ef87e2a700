#include "collision/box_axes.hpp"

#include <Eigen/Eigenvalues>

#include "fringe/triangle.hpp"

namespace fringe::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Returns eigenvectors as rows. They are orthonormal even for equal eigenvalues, since the solver applies
/// orthogonal transformations only.
Matrix3d eigenvectors(const Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  return solver.eigenvectors().rowwise().reverse().transpose();
}

}  // namespace

Matrix3d axes_of_vertices(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points)
    mean += point / static_cast<double>(points.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& point : points)
    covariance += (point - mean) * (point - mean).transpose();
  return eigenvectors(covariance);
}

Matrix3d axes_of_triangles(const std::vector<Vector3d>& points, std::span<const Face> faces) {
  double total = 0;
  Vector3d weighted = Vector3d::Zero();
  for (const auto& [i, j, k] : faces) {
    const double weight = twice_area({points[i], points[j], points[k]});
    total += weight;
    weighted += weight * (points[i] + points[j] + points[k]) / 3;
  }
  if (total == 0)
    return axes_of_vertices(points);
  const Vector3d mean = weighted / total;
  Matrix3d covariance = Matrix3d::Zero();
  for (const auto& [i, j, k] : faces) {
    const Vector3d p = points[i] - mean, q = points[j] - mean, r = points[k] - mean, sum = p + q + r;
    covariance += twice_area({points[i], points[j], points[k]}) / total *
                  (sum * sum.transpose() + p * p.transpose() + q * q.transpose() + r * r.transpose());
  }
  return eigenvectors(covariance);
}

}  // namespace fringe::detail
