#include "bem/single_layer_panels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "bem/charge_kernels.hpp"
#include "bem/panel_quadrature.hpp"
#include "bem/patch_distance.hpp"
#include "bem/single_layer_faces.hpp"
#include "integral/batch/kernels.hpp"
#include "numeric/interruption.hpp"
#include "numeric/triangle_rules.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Adds up panels' potentials at points, and evaluates them many at a time.
class PotentialSums {
 public:
  /// Adds weight·(the potential of the panel at the point) to `sum`, at the latest when flush() is called.
  void add(const Triangle& source, const Vector3d& point, double weight, double& sum) {
    if (size_ == capacity)
      flush();
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t axis = 0; axis < 3; ++axis)
        components_[3 * corner + axis][size_] =
            source[corner][static_cast<Index>(axis)] - point[static_cast<Index>(axis)];
    weights_[size_] = weight;
    sums_[size_++] = &sum;
  }

  void flush() {
    const double* components[9];
    for (std::size_t k = 0; k < 9; ++k)
      components[k] = components_[k].data();
    std::array<double, capacity> potentials{};
    best_kernels<ChargeKernels>().triangle_potentials(components, size_, potentials.data());
    for (std::size_t k = 0; k < size_; ++k)
      *sums_[k] += weights_[k] * potentials[k];
    size_ = 0;
  }

 private:
  static constexpr std::size_t capacity = 256;
  std::array<std::array<double, capacity>, 9> components_{};
  std::array<double, capacity> weights_{};
  std::array<double*, capacity> sums_{};
  std::size_t size_ = 0;
};

/// Computes means of 1/r between panels that are far apart, by a rule of degree 2 on every panel.
class FarPairs {
 public:
  explicit FarPairs(std::span<const Panel> panels)
      : stride_(padded(panels.size())), columns_(9 * stride_, 0.0) {
    for (std::size_t panel = 0; panel < panels.size(); ++panel) {
      const Triangle& corners = panels[panel].corners;
      for (std::size_t k = 0; k < points; ++k) {
        const TriangleNode& node = rule().nodes[k];
        const Vector3d point =
            corners[0] + node.second * (corners[1] - corners[0]) + node.third * (corners[2] - corners[0]);
        for (std::size_t axis = 0; axis < 3; ++axis)
          columns_[(3 * k + axis) * stride_ + panel] = point[static_cast<Index>(axis)];
      }
    }
  }

  /// Computes the means of 1/r between a panel and the first `count`. Those of nearby panels have to be
  /// replaced.
  void fill(const Panel& panel, std::size_t count, double* means) const {
    /// Number of columns whose distances fit in a cache of 32 kB.
    constexpr std::size_t together = 512;
    std::array<double, points * 3> rows{};
    for (std::size_t k = 0; k < points; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        rows[3 * k + axis] = node(panel, k)[static_cast<Index>(axis)];
    std::array<double, points * together> values{};
    for (std::size_t begin = 0; begin < count; begin += together) {
      const std::size_t here = std::min(together, count - begin), stride = padded(here);
      std::fill_n(means + begin, here, 0.0);
      for (std::size_t k = 0; k < points; ++k) {
        const double* const columns[3] = {columns_.data() + (3 * k) * stride_ + begin,
                                          columns_.data() + (3 * k + 1) * stride_ + begin,
                                          columns_.data() + (3 * k + 2) * stride_ + begin};
        best_kernels<BatchKernels>().soft_inverse_distances(columns, stride, rows.data(), points, 0,
                                                            values.data());
        for (std::size_t c = 0; c < here; ++c)
          means[begin + c] += (values[c] + values[stride + c] + values[2 * stride + c]) / (points * points);
      }
    }
  }

 private:
  static constexpr std::size_t points = 3;

  static const TriangleRule& rule() {
    const auto rules = triangle_rules();
    return *std::find_if(rules.begin(), rules.end(), [](const TriangleRule& rule) {
      return static_cast<std::size_t>(rule.points) == points;
    });
  }

  static Vector3d node(const Panel& panel, std::size_t k) {
    static const TriangleRule& used = rule();
    const auto& [a, b, c] = panel.corners;
    return a + used.nodes[k].second * (b - a) + used.nodes[k].third * (c - a);
  }

  static std::size_t padded(std::size_t count) {
    return (count + TriangleArrays::padding - 1) / TriangleArrays::padding * TriangleArrays::padding;
  }

  std::size_t stride_;
  std::vector<double> columns_;  ///< x, y, z of the panels' first points, then of their second …
};

/// Distance, relative to the smaller radius, below which a point lies on a triangle, its sides or its
/// corners. It is above rounding, and an error of this size in a common point has no visible effect.
constexpr double same_point = 1e-9;

/// A triangle's plane, and which of its points are within the triangle.
class PanelPlane {
 public:
  explicit PanelPlane(const Panel& panel)
      : corners_(panel.corners),
        normal_((corners_[1] - corners_[0]).cross(corners_[2] - corners_[0]).normalized()) {}

  double height(const Vector3d& point) const { return normal_.dot(point - corners_[0]); }

  /// Tests whether a point of the plane is in the triangle, or no farther than `near` outside it.
  bool holds(const Vector3d& point, double near) const {
    for (std::size_t side = 0; side < 3; ++side) {
      const Vector3d along = corners_[(side + 1) % 3] - corners_[side];
      if (normal_.dot(along.cross(point - corners_[side])) < -near * along.norm())
        return false;
    }
    return true;
  }

  /// Returns the fraction of the way along a segment at which it passes through the inside of the triangle;
  /// nothing if it does not.
  std::optional<double> crossing(const Vector3d& from, const Vector3d& to, double near) const {
    const double first = height(from), last = height(to);
    if (!((first > near && last < -near) || (first < -near && last > near)))
      return std::nullopt;
    const double part = first / (first - last);
    return holds(from + part * (to - from), near) ? std::optional(part) : std::nullopt;
  }

 private:
  const Triangle& corners_;
  Vector3d normal_;
};

/// Returns a point where two triangles cross, or overlap in one plane, if no corner of one lies on the
/// other's outline; nothing if they are apart.
std::optional<Vector3d> crossing_point(const Panel& a, const Panel& b, double near) {
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const PanelPlane plane(*other);
    const std::array<double, 3> heights{plane.height(one->corners[0]), plane.height(one->corners[1]),
                                        plane.height(one->corners[2])};
    const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
    if (low > near || high < -near)
      return std::nullopt;
    for (std::size_t side = 0; side < 3; ++side) {
      const Vector3d &from = one->corners[side], &to = one->corners[(side + 1) % 3];
      if (std::abs(heights[side]) <= near && plane.holds(from, near))
        return from;
      if (const auto part = plane.crossing(from, to, near))
        return from + *part * (to - from);
    }
    if (std::max(high, -low) > near)
      continue;
    for (std::size_t side = 0; side < 3; ++side)
      for (std::size_t across = 0; across < 3; ++across) {
        const Vector3d &from = one->corners[side], &to = one->corners[(side + 1) % 3];
        const Vector3d &low_end = other->corners[across], &high_end = other->corners[(across + 1) % 3];
        const NearestParts nearest = nearest_parts(from, to, low_end, high_end);
        const Vector3d point = from + nearest.a * (to - from);
        if ((point - low_end - nearest.b * (high_end - low_end)).norm() <= near)
          return point;
      }
  }
  return std::nullopt;
}

/// Returns a point that two triangles have in common, if possible a corner; nothing if there is none.
std::optional<Vector3d> common_point(const Panel& a, const Panel& b) {
  const double near = same_point * std::min(a.radius, b.radius);
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (const Vector3d& corner : one->corners)
      if (outline_distance(other->corners, corner) <= near)
        return corner;
  return crossing_point(a, b, near);
}

/// The singularities of a panel's potential along a segment: its sides, but only the ends of a side that lies
/// on the same line as the segment.
class SingularSides {
 public:
  SingularSides(const Triangle& source, const Vector3d& from, const Vector3d& to, double near)
      : source_(source) {
    const Vector3d along = (to - from).normalized();
    for (std::size_t side = 0; side < 3; ++side)
      is_collinear_[side] = along.cross(source[side] - from).norm() <= near &&
                            along.cross(source[(side + 1) % 3] - from).norm() <= near;
  }

  double distance(const Vector3d& p, const Vector3d& q) const {
    return std::min({distance(p, q, 0), distance(p, q, 1), distance(p, q, 2)});
  }

 private:
  double distance(const Vector3d& p, const Vector3d& q, std::size_t side) const {
    const Vector3d &from = source_[side], &to = source_[(side + 1) % 3];
    return is_collinear_[side] ? std::min(segment_distance(from, p, q), segment_distance(to, p, q))
                               : segment_distance(p, q, from, to);
  }

  const Triangle& source_;
  std::array<bool, 3> is_collinear_{};
};

/// Adds the interaction of two panels that touch, cross or overlap. When both triangles grow by a factor λ
/// about a common point, the integral over both grows by λ³. It is therefore a third of what their moving
/// sides contribute: the potential of each triangle along the other's sides, times the speed of the sides.
/// Where a side passes through the other triangle, the potential has a kink.
void add_touching(const Panel& a, const Panel& b, const Vector3d& common, double tolerance,
                  PotentialSums& sums, double& sum) {
  const double near = same_point * std::min(a.radius, b.radius);
  for (const auto& pair : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const Panel &moving = *pair.first, &source = *pair.second;
    const PanelPlane plane(source);
    for (std::size_t side = 0; side < 3; ++side) {
      const Vector3d &from = moving.corners[side], &to = moving.corners[(side + 1) % 3];
      const double swept = (from - common).cross(to - common).norm() / moving.area;
      // Speed below which a side rests. No side moves inwards: the common point lies in the triangle or on
      // its outline.
      constexpr double none = 1e-8;
      if (swept <= none)
        continue;
      const SingularSides singular(source.corners, from, to, near);
      const auto integrate = [&](const Vector3d& begin, const Vector3d& end, double share) {
        for_each_point(
            begin, end, tolerance,
            [&](const Vector3d& p, const Vector3d& q) { return singular.distance(p, q); },
            [&](const Vector3d& point, double weight) {
              sums.add(source.corners, point, share * weight * swept / 3, sum);
            });
      };
      if (const auto part = plane.crossing(from, to, near)) {
        const Vector3d middle = from + *part * (to - from);
        integrate(from, middle, *part);
        integrate(middle, to, 1 - *part);
      } else {
        integrate(from, to, 1);
      }
    }
  }
}

void add_near(const Panel& a, const Panel& b, double tolerance, PotentialSums& sums, double& sum) {
  const Panel &outer = a.radius < b.radius ? a : b, &inner = a.radius < b.radius ? b : a;
  const double safe = 2 * inner.radius;
  const auto distance = [&](const Vector3d& point) {
    const double centres = (point - inner.centre).norm();
    return centres > safe ? centres - inner.radius : outline_distance(inner.corners, point);
  };
  const auto lay = [&](const Vector3d& point, double weight) { sums.add(inner.corners, point, weight, sum); };
  // By reference, because a copy of the lambda would copy what it captures for every pair.
  for_each_point(outer.corners, tolerance, std::ref(distance), std::ref(lay));
}

/// Computes rows of the matrix; collects near pairs to evaluate many at a time.
class MatrixRows {
 public:
  MatrixRows(std::span<const Panel> panels, double tolerance)
      : panels_(panels), tolerance_(tolerance), farthest_(1 / far_ratio(tolerance)), far_(panels) {}

  /// Computes the interactions of a panel with the first `count`, except those that `is_known` has written.
  /// The row is complete after flush().
  template <class IsKnown>
  void fill(const Panel& panel, std::size_t count, double* row, const IsKnown& is_known) {
    check_interruption();
    far_.fill(panel, count, row);
    for (std::size_t j = 0; j < count; ++j) {
      const Panel& other = panels_[j];
      const double radii = panel.radius + other.radius, reach = farthest_ * radii;
      const double squared = (panel.centre - other.centre).squaredNorm();
      if (squared > reach * reach || is_known(j))
        continue;
      row[j] = 0;
      const std::optional<Vector3d> common =
          squared <= radii * radii ? common_point(panel, other) : std::nullopt;
      if (common)
        add_touching(panel, other, *common, tolerance_, sums_, row[j]);
      else
        add_near(panel, other, tolerance_, sums_, row[j]);
    }
  }

  void flush() { sums_.flush(); }

 private:
  std::span<const Panel> panels_;
  double tolerance_;
  double farthest_;
  FarPairs far_;
  PotentialSums sums_;
};

}  // namespace

double panel_self(const Panel& panel) {
  const auto& [a, b, c] = panel.corners;
  const std::array<double, 3> sides{(b - a).norm(), (c - b).norm(), (a - c).norm()};
  const double half = (sides[0] + sides[1] + sides[2]) / 2;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k)
    // The half perimeter minus a side: by the area, because the difference loses digits for a sliver.
    sum +=
        std::log(half / std::max(half - sides[k], panel.area * panel.area / (half * half * half))) / sides[k];
  return 4 * sum / 3;
}

MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance, const KnownElements& known) {
  const auto size = static_cast<Index>(panels.size());
  MatrixXd matrix(size, size);
  MatrixRows rows(panels, tolerance);
  const auto place = [&](std::size_t panel) { return known.places.empty() ? -1 : known.places[panel]; };
  for (std::size_t i = 0; i < panels.size(); ++i) {
    double* const column = matrix.data() + static_cast<Index>(i) * size;
    const Index old_i = place(i);
    rows.fill(panels[i], i, column, [&](std::size_t j) {
      const Index old_j = place(j);
      if (old_i < 0 || old_j < 0)
        return false;
      column[j] = known.matrix(std::min(old_i, old_j), std::max(old_i, old_j));
      return true;
    });
    column[i] = panel_self(panels[i]);
  }
  rows.flush();
  return matrix;
}

MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance) {
  return single_layer_matrix(panels, tolerance, {MatrixXd(), {}});
}

MatrixXd panel_potentials(std::span<const Panel> targets, std::span<const Panel> panels,
                          const MatrixXd& charges, double tolerance) {
  MatrixXd result(static_cast<Index>(targets.size()), charges.cols());
  MatrixRows rows(panels, tolerance);
  Eigen::VectorXd row(charges.rows());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    rows.fill(targets[k], panels.size(), row.data(), [](std::size_t) { return false; });
    rows.flush();
    result.row(static_cast<Index>(k)) = row.transpose() * charges;
  }
  return result;
}

MatrixXd single_layer_block(const ChargedFace& face, FaceFunctions functions, std::span<const Panel> panels,
                            double tolerance) {
  const std::array<Vector3d, 4> corners = corners_of(face);
  // The potential of a smooth charge is smooth beside it, except near its edges.
  const auto distance = [&](const Vector3d& point) {
    double least = segment_distance(point, corners[3], corners[0]);
    for (std::size_t k = 0; k < 3; ++k)
      least = std::min(least, segment_distance(point, corners[k], corners[k + 1]));
    return least;
  };
  std::vector<Vector3d> points;
  std::vector<double> weights;
  std::vector<std::size_t> ends;
  for (const Panel& panel : panels) {
    for_each_point(panel.corners, tolerance, distance, [&](const Vector3d& point, double weight) {
      points.push_back(point);
      weights.push_back(weight);
    });
    ends.push_back(points.size());
  }
  const MatrixXd potentials = face_potentials(face, functions, points, tolerance);
  MatrixXd result = MatrixXd::Zero(functions.count(), static_cast<Index>(panels.size()));
  std::size_t at = 0;
  for (std::size_t panel = 0; panel < panels.size(); ++panel)
    for (; at < ends[panel]; ++at)
      result.col(static_cast<Index>(panel)) += weights[at] * potentials.col(static_cast<Index>(at));
  return result;
}

}  // namespace fringe::detail
