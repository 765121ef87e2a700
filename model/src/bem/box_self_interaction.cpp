#include "bem/box_self_interaction.hpp"

#include <algorithm>
#include <cmath>

#include "bem/face_self_interaction.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

/// Half the range of the tanh-sinh rules in their variable t.
constexpr double reach = 3.3;

/// Returns the number of quadrature points, as in face_self_interaction.cpp; here the nodes cluster at the
/// shared edge and its ends.
int points_of(int functions) {
  return 40 + 3 * functions;
}

/// Quadrature nodes that suffice for a number of functions.
struct BoxNodes {
  explicit BoxNodes(int functions) {
    const TanhSinhRule rule = tanh_sinh_rule(points_of(functions), reach), overlap = overlap_rule(functions);
    const EvenPairs pairs(functions);
    const auto count = static_cast<Eigen::Index>(rule.weights.size());
    distance.resize(count);
    correlation.resize(pairs.size(), count);
    function.resize(functions, count);
    for (Eigen::Index q = 0; q < count; ++q) {
      check_interruption();
      const auto at = static_cast<std::size_t>(q);
      const double left = 2 * rule.from_left[at], right = 2 * rule.from_right[at];
      const double weight = 2 * rule.weights[at];
      distance[q] = left;
      correlation.col(q) =
          weight * correlations(EdgeKind::right_angle, pairs, functions, left, right, overlap);
      weighted_polynomials(EdgeKind::right_angle).evaluate(left - 1, functions, function.col(q).data());
      function.col(q) *= weight * edge_weight(EdgeKind::right_angle, left, right);
    }
  }
  Eigen::ArrayXd distance;      ///< in [0, 2]: between two points along an edge, or of a point from an edge
  Eigen::MatrixXd correlation;  ///< of every even pair, times the weights
  Eigen::MatrixXd function;     ///< values of every function, times the weights
};

const BoxNodes& box_nodes(int functions) {
  if (functions <= 7) {
    static const BoxNodes few(7);
    return few;
  }
  if (functions <= 15) {
    static const BoxNodes more(15);
    return more;
  }
  static const BoxNodes all(most_functions);
  return all;
}

/// Returns the sign that f_k takes when its face is mirrored.
double mirrored(int k, bool mirror) {
  return mirror && k % 2 != 0 ? -1 : 1;
}

}  // namespace

std::array<ChargedFace, box_faces> faces_of_box(const Eigen::Vector3d& half_sides) {
  std::array<ChargedFace, box_faces> faces;
  for (std::size_t k = 0; k < box_faces; ++k) {
    const auto axis = static_cast<Eigen::Index>(k / 2);
    const Eigen::Index u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    faces[k] = {(k % 2 == 0 ? -half_sides[axis] : half_sides[axis]) * Eigen::Vector3d::Unit(axis),
                Eigen::Vector3d::Unit(u),
                Eigen::Vector3d::Unit(v),
                half_sides[u],
                half_sides[v],
                EdgeKind::right_angle};
  }
  return faces;
}

Eigen::MatrixXd opposite_faces(FaceFunctions first, FaceFunctions second, double a, double b,
                               double distance) {
  const int along_u = std::max(first.u, second.u), along_v = std::max(first.v, second.v);
  const BoxNodes& nodes = box_nodes(std::max(along_u, along_v));
  const Eigen::Index count_u = EvenPairs(along_u).size(), count_v = EvenPairs(along_v).size();
  const Eigen::ArrayXd across = (b * nodes.distance).square() + distance * distance;
  Eigen::MatrixXd kernel(nodes.distance.size(), nodes.distance.size());
  for (Eigen::Index q = 0; q < nodes.distance.size(); ++q)
    kernel.col(q) = (across + (a * nodes.distance[q]) * (a * nodes.distance[q])).rsqrt();
  const Eigen::MatrixXd sums = nodes.correlation.topRows(count_u) * kernel.transpose() *
                               nodes.correlation.topRows(count_v).transpose();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(first.count(), second.count());
  for (int i = 0; i < first.u; ++i)
    for (int k = i % 2; k < second.u; k += 2)
      for (int j = 0; j < first.v; ++j)
        for (int l = j % 2; l < second.v; l += 2)
          result(i * first.v + j, k * second.v + l) =
              4 * sums(EvenPairs::index(i, k), EvenPairs::index(j, l));
  return result;
}

Eigen::MatrixXd adjacent_faces(FaceFunctions first, FaceFunctions second, double shared, double first_width,
                               double second_width) {
  const int along = std::max(first.u, second.u);
  const BoxNodes& nodes = box_nodes(std::max({along, first.v, second.v}));
  const Eigen::Index pairs = EvenPairs(along).size();
  const auto rows = nodes.function.topRows(first.v), columns = nodes.function.topRows(second.v);
  const Eigen::ArrayXd first_square = (first_width * nodes.distance).square();
  const Eigen::ArrayXd second_square = (second_width * nodes.distance).square();
  Eigen::MatrixXd across(first.v * second.v, nodes.distance.size());
  Eigen::MatrixXd kernel(nodes.distance.size(), nodes.distance.size());
  for (Eigen::Index q = 0; q < nodes.distance.size(); ++q) {
    check_interruption();
    const double square = (shared * nodes.distance[q]) * (shared * nodes.distance[q]);
    for (Eigen::Index r = 0; r < nodes.distance.size(); ++r)
      kernel.col(r) = (first_square + (square + second_square[r])).rsqrt();
    Eigen::Map<Eigen::MatrixXd>(across.col(q).data(), first.v, second.v).noalias() =
        rows * kernel * columns.transpose();
  }
  const Eigen::MatrixXd sums = 2 * nodes.correlation.topRows(pairs) * across.transpose();
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
  for (std::size_t face = 0; face < box_faces; ++face) {
    const auto [u, v] = functions[face];
    place(face, face,
          face_self_interaction(EdgeKind::right_angle, std::max(u, v))
              .matrix(u, v, faces[face].half_u, faces[face].half_v));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t low = 2 * axis, high = low + 1;
    place(low, high,
          opposite_faces(functions[low], functions[high], faces[low].half_u, faces[low].half_v,
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
