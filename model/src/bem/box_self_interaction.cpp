#include "bem/box_self_interaction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bem/face_self_interaction.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

/// The sum Σ_m factor_m·exp(−τ_m²r²), which is 1/r for all distances r that matter in a box whose half
/// diagonal is one: the trapezoidal rule for (2/√π)·∫exp(−τ²r²) dτ, where ln τ falls doubly exponentially
/// towards τ = 0.
struct GaussianSum {
  GaussianSum() {
    constexpr int points = 140;
    constexpr double from = -2.5, to = 7.05, step = (to - from) / (points - 1);
    const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(points, from, to);
    const Eigen::ArrayXd grow = 0.0125 * t.exp(), fall = 2 * (-t).exp();
    tau = (1.6 * t + grow - fall).exp();
    factor = 2 / std::sqrt(std::numbers::pi) * step * tau * (1.6 + grow + fall);
  }
  Eigen::ArrayXd tau;
  Eigen::ArrayXd factor;
};

/// Returns the sums Σ_q values(·, q)·exp(−(width·distance_q)²τ²), a column for every τ.
Eigen::MatrixXd gaussian_transform(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                   const Eigen::ArrayXd& distance, double width, const Eigen::ArrayXd& tau) {
  const Eigen::ArrayXd square = -(width * distance).square();
  Eigen::MatrixXd gaussians(distance.size(), tau.size());
  for (Eigen::Index m = 0; m < tau.size(); ++m)
    gaussians.col(m) = (square * (tau[m] * tau[m])).exp();
  return values * gaussians;
}

/// Returns the sign that f_k takes when its face is mirrored.
double mirrored(int k, bool mirror) {
  return mirror && k % 2 != 0 ? -1 : 1;
}

}  // namespace

Eigen::MatrixXd adjacent_faces(FaceFunctions first, FaceFunctions second, double shared, double first_width,
                               double second_width) {
  check_interruption();
  static const GaussianSum inverse;
  const int along = std::max(first.u, second.u);
  const DistanceRule& rule = distance_rule(EdgeKind::right_angle, std::max({along, first.v, second.v}));
  const double size = std::hypot(shared, first_width, second_width);
  const Eigen::ArrayXd tau = inverse.tau / size;
  const Eigen::MatrixXd rows =
      gaussian_transform(rule.function.topRows(first.v), rule.distance, first_width, tau);
  const Eigen::MatrixXd columns =
      gaussian_transform(rule.function.topRows(second.v), rule.distance, second_width, tau);
  Eigen::MatrixXd across(first.v * second.v, tau.size());
  for (Eigen::Index m = 0; m < tau.size(); ++m)
    Eigen::Map<Eigen::MatrixXd>(across.col(m).data(), first.v, second.v) =
        (2 * inverse.factor[m] / size) * rows.col(m) * columns.col(m).transpose();
  const Eigen::MatrixXd sums =
      gaussian_transform(rule.correlation.topRows(EvenPairs(along).size()), rule.distance, shared, tau) *
      across.transpose();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(first.count(), second.count());
  for (int s = 0; s < first.u; ++s)
    for (int t = s % 2; t < second.u; t += 2)
      for (int j = 0; j < first.v; ++j)
        for (int l = 0; l < second.v; ++l)
          result(s * first.v + j, t * second.v + l) = sums(EvenPairs::index(s, t), j + l * first.v);
  return result;
}

namespace {

/// Return a face's number of functions along an axis, and across it.
int along_axis(const ChargedFace& face, FaceFunctions functions, Eigen::Index axis) {
  return face.axis_u[axis] == 1 ? functions.u : functions.v;
}
int across_axis(const ChargedFace& face, FaceFunctions functions, Eigen::Index axis) {
  return face.axis_u[axis] == 1 ? functions.v : functions.u;
}

/// Gives the single-layer blocks of adjacent faces of a box. It holds the block of the faces +a and +b,
/// mirrored to meet at their ends −1, for the largest numbers of functions that any of the faces has.
class AdjacentFaces {
 public:
  AdjacentFaces(const Eigen::Vector3d& half_sides, const std::array<ChargedFace, box_faces>& faces,
                const std::array<FaceFunctions, box_faces>& functions, std::size_t axis_a, std::size_t axis_b)
      : shared_(static_cast<Eigen::Index>(3 - axis_a - axis_b)) {
    for (const std::size_t face : {2 * axis_a, 2 * axis_a + 1}) {
      most_a_.u = std::max(most_a_.u, along_axis(faces[face], functions[face], shared_));
      most_a_.v = std::max(most_a_.v, across_axis(faces[face], functions[face], shared_));
    }
    for (const std::size_t face : {2 * axis_b, 2 * axis_b + 1}) {
      most_b_.u = std::max(most_b_.u, along_axis(faces[face], functions[face], shared_));
      most_b_.v = std::max(most_b_.v, across_axis(faces[face], functions[face], shared_));
    }
    values_ =
        adjacent_faces(most_a_, most_b_, half_sides[shared_], half_sides[static_cast<Eigen::Index>(axis_b)],
                       half_sides[static_cast<Eigen::Index>(axis_a)]);
  }

  /// Returns the block of two faces. `positive_a` and `positive_b` tell whether they are at the positive ends
  /// of their axes. A face meets the other at its end +1 if the other one is at a positive end.
  Eigen::MatrixXd block(const ChargedFace& a, FaceFunctions in_a, bool positive_a, const ChargedFace& b,
                        FaceFunctions in_b, bool positive_b) const {
    Eigen::MatrixXd result(in_a.count(), in_b.count());
    const bool a_along_u = a.axis_u[shared_] == 1, b_along_u = b.axis_u[shared_] == 1;
    for (int row = 0; row < in_a.count(); ++row)
      for (int column = 0; column < in_b.count(); ++column) {
        const int i = row / in_a.v, j = row % in_a.v, k = column / in_b.v, l = column % in_b.v;
        const int along_a = a_along_u ? i : j, across_a = a_along_u ? j : i;
        const int along_b = b_along_u ? k : l, across_b = b_along_u ? l : k;
        result(row, column) = mirrored(across_a, positive_b) * mirrored(across_b, positive_a) *
                              values_(along_a * most_a_.v + across_a, along_b * most_b_.v + across_b);
      }
    return result;
  }

 private:
  Eigen::Index shared_;
  FaceFunctions most_a_{0, 0};
  FaceFunctions most_b_{0, 0};
  Eigen::MatrixXd values_;
};

}  // namespace

Eigen::MatrixXd box_self_interaction(const Eigen::Vector3d& half_sides,
                                     const std::array<FaceFunctions, box_faces>& functions) {
  std::array<Eigen::Index, box_faces + 1> starts{};
  for (std::size_t k = 0; k < box_faces; ++k)
    starts[k + 1] = starts[k] + functions[k].count();
  const std::array<ChargedFace, box_faces> faces = faces_of_box(half_sides);
  Eigen::MatrixXd result(starts[box_faces], starts[box_faces]);
  const auto place = [&](std::size_t a, std::size_t b, const Eigen::MatrixXd& block) {
    result.block(starts[a], starts[b], block.rows(), block.cols()) = block;
    result.block(starts[b], starts[a], block.cols(), block.rows()) = block.transpose();
  };
  for (std::size_t face = 0; face < box_faces; ++face)
    place(face, face, face_self_interaction(faces[face], functions[face]));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t low = 2 * axis, high = low + 1;
    const DistanceRule& rule =
        distance_rule(EdgeKind::right_angle,
                      std::max({functions[low].u, functions[low].v, functions[high].u, functions[high].v}));
    place(low, high,
          parallel_faces(rule, functions[low], functions[high], faces[low].half_u, faces[low].half_v,
                         2 * half_sides[static_cast<Eigen::Index>(axis)]));
    for (std::size_t other = axis + 1; other < 3; ++other) {
      const AdjacentFaces adjacent(half_sides, faces, functions, axis, other);
      for (const std::size_t a : {low, high})
        for (const std::size_t b : {2 * other, 2 * other + 1})
          place(a, b, adjacent.block(faces[a], functions[a], a == high, faces[b], functions[b], b % 2 != 0));
    }
  }
  return result;
}

}  // namespace fringe::detail
