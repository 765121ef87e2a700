#include "convex_programme.hpp"

#include <array>
#include <cmath>

namespace fringe::test {
namespace {

using std::size_t;
using Vector = std::array<Real, 3>;

/// Up to three variables: two barycentric coordinates and, in the first phase, the margin to the cone.
using Variables = std::array<Real, 3>;
using Matrix = std::array<Variables, 3>;

Real inner(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector difference(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vector real(const Eigen::Vector3d& a) {
  return {Real(a.x()), Real(a.y()), Real(a.z())};
}

/// Solves H·x = g for a positive definite H by Cholesky decomposition.
Variables solve_linear(Matrix h, Variables g, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j < i; ++j) {
      for (size_t k = 0; k < j; ++k)
        h[i][j] -= h[i][k] * h[j][k];
      h[i][j] /= h[j][j];
      h[i][i] -= h[i][j] * h[i][j];
      g[i] -= h[i][j] * g[j];
    }
    h[i][i] = sqrt(h[i][i]);
    g[i] /= h[i][i];
  }
  for (size_t i = count; i-- > 0;) {
    for (size_t k = i + 1; k < count; ++k)
      g[i] -= h[k][i] * g[k];
    g[i] /= h[i][i];
  }
  return g;
}

/// The convex programme over points q = last + Σ xᵢ·sides[i] with x₀, x₁, 1 − x₀ − x₁ > 0 and axis·q − margin
/// > cosine·|q|. With three variables it maximises the margin, x₂; with two variables the margin is 0 and it
/// minimises |q|².
class Programme {
 public:
  Programme(const Triangle& triangle, const SensingCone& cone, double enlargement) {
    const Vector apex = real(cone.apex);
    std::array<Vector, 3> corners;
    for (size_t i = 0; i < 3; ++i) {
      corners[i] = difference(real(triangle[i]), apex);
      for (const Real& component : corners[i])
        size_ = std::max(size_, Real(abs(component)));
    }
    if (size_ == 0)
      size_ = 1;
    for (Vector& corner : corners)
      for (Real& component : corner)
        component /= size_;
    last_ = corners[2];
    sides_ = {difference(corners[0], last_), difference(corners[1], last_)};
    axis_ = real(cone.direction);
    const Real length = sqrt(inner(axis_, axis_));
    for (Real& component : axis_)
      component /= length;
    cosine_squared_ = cos(Real(cone.full_angle) / 2 + Real(enlargement));
    cosine_squared_ *= cosine_squared_;
  }

  ProgrammeAnswer answer() {
    x_ = {Real(1) / 3, Real(1) / 3, Real(-3)};
    const Visibility visibility = maximise_margin();
    if (visibility != Visibility::visible)
      return {visibility, 0};
    count_ = 2;
    x_[2] = 0;
    const Real start = inner(point(), point());
    // The barriers' self-concordance parameters add up to five, so |q|² exceeds its minimum by at most
    // 5/weight.
    for (weight_ = 1 / start; 5 / weight_ > Real(1e-30) * inner(point(), point()); weight_ *= 50)
      centre();
    Vector q = point();
    for (Real& component : q)
      component *= size_;
    return {Visibility::visible, sqrt(inner(q, q)), q};
  }

 private:
  Vector point() const {
    Vector q = last_;
    for (size_t i = 0; i < 2; ++i)
      for (size_t k = 0; k < 3; ++k)
        q[k] += x_[i] * sides_[i][k];
    return q;
  }

  Visibility maximise_margin() {
    count_ = 3;
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
      Variables gradient{};
      Matrix hessian{};
      differentiate(gradient, hessian);
      const Variables step = solve_linear(hessian, gradient, count_);
      Real square = 0;
      for (size_t i = 0; i < count_; ++i)
        square += step[i] * gradient[i];
      const Real decrement = sqrt(square), damping = decrement > Real(0.25) ? 1 / (1 + decrement) : Real(1);
      for (size_t i = 0; i < count_; ++i)
        x_[i] -= damping * step[i];
      if (decrement < Real(0.01))
        return;
    }
  }

  void differentiate(Variables& gradient, Matrix& hessian) const {
    const Vector q = point();
    const Real margin = inner(axis_, q) - x_[2];
    const Real inside = margin * margin - cosine_squared_ * inner(q, q);
    const Variables of_margin{inner(axis_, sides_[0]), inner(axis_, sides_[1]), -1};
    const Real third = 1 - x_[0] - x_[1];
    Variables of_inside{};
    for (size_t i = 0; i < count_; ++i)
      of_inside[i] =
          2 * margin * of_margin[i] - (i < 2 ? 2 * cosine_squared_ * inner(q, sides_[i]) : Real(0));
    for (size_t i = 0; i < count_; ++i) {
      gradient[i] = -of_inside[i] / inside;
      if (i < 2)
        gradient[i] += 1 / third - 1 / x_[i];
      if (count_ == 2)
        gradient[i] += 2 * weight_ * inner(q, sides_[i]);
      for (size_t j = 0; j <= i; ++j) {
        Real second = 2 * of_margin[i] * of_margin[j];
        const Real product = i < 2 ? inner(sides_[i], sides_[j]) : Real(0);
        second -= 2 * cosine_squared_ * product;
        hessian[i][j] = of_inside[i] * of_inside[j] / (inside * inside) - second / inside;
        if (i < 2)
          hessian[i][j] += 1 / (third * third) + (i == j ? Real(1 / (x_[i] * x_[i])) : Real(0));
        if (count_ == 2)
          hessian[i][j] += 2 * weight_ * product;
      }
    }
    if (count_ == 3)
      gradient[2] -= weight_;
  }

  Vector last_, axis_;
  std::array<Vector, 2> sides_;
  Real cosine_squared_;
  Real size_ = 0;
  Real weight_;
  Variables x_;
  size_t count_ = 0;
};

}  // namespace

ProgrammeAnswer solve(const Triangle& triangle, const SensingCone& cone, double enlargement) {
  return Programme(triangle, cone, enlargement).answer();
}

}  // namespace fringe::test
