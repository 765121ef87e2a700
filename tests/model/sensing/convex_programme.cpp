#include "sensed_triangles.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Cholesky>

namespace fringe::test {
namespace {

/// Up to three variables: two barycentric coordinates and, in the first phase, the margin to the cone.
using Variables = Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, 3, 1>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;

/// The convex programme over points q = last + Σ xᵢ·sides[i] with x₀, x₁, 1 − x₀ − x₁ > 0 and axis·q − margin
/// > cosine·|q|. With three variables it maximises the margin, x₂; with two variables the margin is 0 and it
/// minimises |q|².
class Programme {
 public:
  Programme(const Triangle& triangle, const SensingCone& cone, double enlargement) {
    std::array<RealVector, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = triangle[i].cast<Real>() - cone.apex.cast<Real>();
      for (const Real& component : corners[i])
        size_ = std::max(size_, Real(abs(component)));
    }
    if (size_ == 0)
      size_ = 1;
    last_ = corners[2] / size_;
    sides_.col(0) = corners[0] / size_ - last_;
    sides_.col(1) = corners[1] / size_ - last_;
    axis_ = cone.direction.cast<Real>();
    axis_ /= Real(sqrt(axis_.squaredNorm()));
    cosine_squared_ = cos(Real(cone.full_angle) / 2 + Real(enlargement));
    cosine_squared_ *= cosine_squared_;
  }

  ProgrammeAnswer answer() {
    x_ = RealVector(Real(1) / 3, Real(1) / 3, Real(-3));
    const Visibility visibility = maximise_margin();
    if (visibility != Visibility::visible)
      return {visibility};
    x_.conservativeResize(2);
    const Real start = point().squaredNorm();
    // The barriers' self-concordance parameters add up to five, so |q|² exceeds its minimum by at most
    // 5/weight.
    for (weight_ = 1 / start; 5 / weight_ > Real(1e-30) * point().squaredNorm(); weight_ *= 50)
      centre();
    const RealVector q = size_ * point();
    return {Visibility::visible, sqrt(q.squaredNorm()), q};
  }

 private:
  bool has_margin() const { return x_.size() == 3; }
  RealVector point() const { return last_ + sides_ * x_.head<2>(); }

  Visibility maximise_margin() {
    for (weight_ = 1; weight_ < Real(1e28); weight_ *= 50) {
      centre();
      if (x_[2] > Real(1e-25))
        return Visibility::visible;
      if (x_[2] + 5 / weight_ < Real(-1e-25))
        return Visibility::hidden;
    }
    return Visibility::undecided;
  }

  /// Minimises weight·objective + barriers by damped Newton steps (Nesterov and Nemirovskii).
  void centre() {
    for (;;) {
      Variables gradient = Variables::Zero(x_.size());
      Matrix hessian = Matrix::Zero(x_.size(), x_.size());
      differentiate(gradient, hessian);
      const Variables step = hessian.llt().solve(gradient);
      const Real decrement = sqrt(Real(step.dot(gradient)));
      x_ -= (decrement > Real(0.25) ? Real(1 / (1 + decrement)) : Real(1)) * step;
      if (decrement < Real(0.01))
        return;
    }
  }

  /// Sets the gradient and the lower half of the Hessian matrix.
  void differentiate(Variables& gradient, Matrix& hessian) const {
    const RealVector q = point();
    const Real margin = axis_.dot(q) - (has_margin() ? x_[2] : Real(0));
    const Real inside = margin * margin - cosine_squared_ * q.squaredNorm();
    const RealVector of_margin(axis_.dot(sides_.col(0)), axis_.dot(sides_.col(1)), Real(-1));
    const Real third = 1 - x_[0] - x_[1];
    Variables of_inside = 2 * margin * of_margin.head(x_.size());
    of_inside.head<2>() -= 2 * cosine_squared_ * sides_.transpose() * q;
    for (Eigen::Index i = 0; i < x_.size(); ++i) {
      gradient[i] = -of_inside[i] / inside;
      if (i < 2)
        gradient[i] += 1 / third - 1 / x_[i];
      if (!has_margin())
        gradient[i] += 2 * weight_ * q.dot(sides_.col(i));
      for (Eigen::Index j = 0; j <= i; ++j) {
        const Real product = i < 2 ? Real(sides_.col(i).dot(sides_.col(j))) : Real(0);
        const Real second = 2 * of_margin[i] * of_margin[j] - 2 * cosine_squared_ * product;
        hessian(i, j) = of_inside[i] * of_inside[j] / (inside * inside) - second / inside;
        if (i < 2)
          hessian(i, j) += 1 / (third * third) + (i == j ? Real(1 / (x_[i] * x_[i])) : Real(0));
        if (!has_margin())
          hessian(i, j) += 2 * weight_ * product;
      }
    }
    if (has_margin())
      gradient[2] -= weight_;
  }

  RealVector last_, axis_;
  Eigen::Matrix<Real, 3, 2> sides_;
  Real cosine_squared_;
  Real size_ = 0;
  Real weight_;
  Variables x_;
};

}  // namespace

ProgrammeAnswer solve(const Triangle& triangle, const SensingCone& cone, double enlargement) {
  return Programme(triangle, cone, enlargement).answer();
}

}  // namespace fringe::test
