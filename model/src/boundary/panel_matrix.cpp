#include "panel_matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "../batch/choices.hpp"
#include "../batch/kernels.hpp"
#include "../batch/triangle_rules.hpp"
#include "../kernel.hpp"
#include "panel_rules.hpp"
#include "patch_distance.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Sums of a panel's potential at points, evaluated many at a time.
class PotentialSums {
 public:
  explicit PotentialSums(double tolerance) : choices_(tolerance) {}

  /// Adds weight·(the potential of the panel at the point) to `sum`, by the next flush at the latest.
  void add(const Triangle& source, const Vector3d& point, double weight, double& sum) {
    if (size_ == capacity)
      flush();
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t axis = 0; axis < 3; ++axis)
        components_[3 * corner + axis][size_] =
            source[corner][static_cast<Index>(axis)] - point[static_cast<Index>(axis)];
    // The potential of a charge of one is 2·K.
    weights_[size_] = 2 * weight;
    sums_[size_++] = &sum;
  }

  void flush() {
    VirtualTriangles triangles{};
    for (std::size_t k = 0; k < 9; ++k)
      triangles.components[k] = components_[k].data();
    triangles.weight = weights_.data();
    std::array<double, capacity> values{};
    std::array<std::uint32_t, capacity> left{};
    const std::size_t left_count =
        best_kernels().integrate_virtual(triangles, size_, choices_.choices(), values.data(), left.data());
    for (std::size_t k = 0; k < left_count; ++k) {
      const std::size_t at = left[k];
      const auto corner = [&](std::size_t which) {
        return Vector3d(components_[3 * which][at], components_[3 * which + 1][at],
                        components_[3 * which + 2][at]);
      };
      values[at] = weights_[at] * kernel(corner(0), corner(1), corner(2));
    }
    for (std::size_t k = 0; k < size_; ++k)
      *sums_[k] += values[k];
    size_ = 0;
  }

 private:
  static constexpr std::size_t capacity = 256;
  PreparedChoices choices_;
  std::array<std::array<double, capacity>, 9> components_{};
  std::array<double, capacity> weights_{};
  std::array<double*, capacity> sums_{};
  std::size_t size_ = 0;
};

/// A rule of degree 2 on every panel: 1/r between all their points, where the panels are far apart.
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

  /// The means of 1/r between one panel and the first `count`, itself and its neighbours to be replaced.
  void fill(std::size_t panel, std::size_t count, double* means) const {
    /// A cache of 32 kB holds the distances of so many columns.
    constexpr std::size_t together = 512;
    std::array<double, points * 3> rows{};
    for (std::size_t k = 0; k < points; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        rows[3 * k + axis] = columns_[(3 * k + axis) * stride_ + panel];
    std::array<double, points * together> values{};
    for (std::size_t begin = 0; begin < count; begin += together) {
      const std::size_t here = std::min(together, count - begin), stride = padded(here);
      std::fill_n(means + begin, here, 0.0);
      for (std::size_t k = 0; k < points; ++k) {
        const double* const columns[3] = {columns_.data() + (3 * k) * stride_ + begin,
                                          columns_.data() + (3 * k + 1) * stride_ + begin,
                                          columns_.data() + (3 * k + 2) * stride_ + begin};
        best_kernels().soft_inverse_distances(columns, stride, rows.data(), points, 0, values.data());
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

  static std::size_t padded(std::size_t count) {
    return (count + TriangleArrays::padding - 1) / TriangleArrays::padding * TriangleArrays::padding;
  }

  std::size_t stride_;
  std::vector<double> columns_;  ///< x, y, z of the panels' first points, of their second …
};

/// A corner of one of two triangles that lies on the other.
std::optional<Vector3d> common_point(const Panel& a, const Panel& b) {
  /// What rounding leaves between corners that are one, or beside a side; what is moved by so little does not
  /// show.
  constexpr double same = 1e-9;
  const double near = same * std::min(a.radius, b.radius);
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (const Vector3d& corner : one->corners)
      if (outline_distance(other->corners, corner) <= near)
        return corner;
  return std::nullopt;
}

/// Pairs that touch. The integral over both triangles, grown by a factor λ about a common point, is λ³ times
/// what it was, hence a third of what their sides bring in when they grow: the potential of each along the
/// other's sides, times how fast these move.
void add_touching(const Panel& a, const Panel& b, const Vector3d& common, double tolerance,
                  PotentialSums& sums, double& sum) {
  for (const auto& [moving, source] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (std::size_t side = 0; side < 3; ++side) {
      const Vector3d &from = moving->corners[side], &to = moving->corners[(side + 1) % 3];
      const double swept = (from - common).cross(to - common).norm() / moving->area;
      // The common point lies in the triangle or on its outline: no side moves inwards.
      constexpr double none = 1e-8;
      if (swept <= none)
        continue;
      for_each_point(
          from, to, tolerance,
          [&](const Vector3d& p, const Vector3d& q) {
            const Triangle& c = source->corners;
            return std::min({segment_distance(p, q, c[0], c[1]), segment_distance(p, q, c[1], c[2]),
                             segment_distance(p, q, c[2], c[0])});
          },
          [&](const Vector3d& point, double weight) {
            sums.add(source->corners, point, weight * swept / 3, sum);
          });
    }
}

void add_near(const Panel& a, const Panel& b, double tolerance, PotentialSums& sums, double& sum) {
  const Panel &outer = a.radius < b.radius ? a : b, &inner = a.radius < b.radius ? b : a;
  const double safe = 2 * inner.radius;
  for_each_point(
      outer.corners, tolerance,
      [&](const Vector3d& point) {
        const double centres = (point - inner.centre).norm();
        return centres > safe ? centres - inner.radius : outline_distance(inner.corners, point);
      },
      [&](const Vector3d& point, double weight) { sums.add(inner.corners, point, weight, sum); });
}

}  // namespace

double panel_self(const Panel& panel) {
  const auto& [a, b, c] = panel.corners;
  const std::array<double, 3> sides{(b - a).norm(), (c - b).norm(), (a - c).norm()};
  const double half = (sides[0] + sides[1] + sides[2]) / 2;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k)
    // The half perimeter less a side, without the difference that loses a sliver's digits: by the area.
    sum +=
        std::log(half / std::max(half - sides[k], panel.area * panel.area / (half * half * half))) / sides[k];
  return 4 * sum / 3;
}

MatrixXd panel_matrix(std::span<const Panel> panels, double tolerance) {
  const auto size = static_cast<Index>(panels.size());
  MatrixXd matrix(size, size);
  const FarPairs far(panels);
  PotentialSums sums(tolerance / 10);
  const double farthest = 1 / far_ratio(tolerance);
  // The columns of the matrix are filled whole registers at a time.
  std::vector<double> means(panels.size() + TriangleArrays::padding);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Panel& panel = panels[i];
    far.fill(i, i, means.data());
    double* const column = matrix.data() + static_cast<Index>(i) * size;
    std::copy_n(means.begin(), i, column);
    for (std::size_t j = 0; j < i; ++j) {
      const double radii = panel.radius + panels[j].radius, reach = farthest * radii;
      const double squared = (panel.centre - panels[j].centre).squaredNorm();
      if (squared > reach * reach)
        continue;
      column[j] = 0;
      const std::optional<Vector3d> common =
          squared <= radii * radii ? common_point(panel, panels[j]) : std::nullopt;
      if (common)
        add_touching(panel, panels[j], *common, tolerance, sums, column[j]);
      else
        add_near(panel, panels[j], tolerance, sums, column[j]);
    }
    column[i] = panel_self(panel);
  }
  sums.flush();
  return matrix;
}

}  // namespace fringe::detail
