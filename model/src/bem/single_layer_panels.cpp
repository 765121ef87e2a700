#include "bem/single_layer_panels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bem/panel_pair.hpp"
#include "bem/panel_quadrature.hpp"
#include "bem/patch_distance.hpp"
#include "bem/single_layer_faces.hpp"
#include "integral/batch/kernels.hpp"
#include "numeric/parallel.hpp"
#include "numeric/quadrature_rules.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr std::size_t padded(std::size_t count) {
  return (count + TriangleArrays::padding - 1) / TriangleArrays::padding * TriangleArrays::padding;
}

}  // namespace

PointCharges::PointCharges(std::span<const Panel> panels, int degree)
    : rule_(triangle_rule(degree)), stride_(padded(panels.size()) + TriangleArrays::padding),
      coordinates_(3 * static_cast<std::size_t>(rule_.points) * stride_, 0.0) {
  for (std::size_t panel = 0; panel < panels.size(); ++panel)
    for (std::size_t k = 0; k < points(); ++k) {
      const Vector3d point = point_of(panels[panel].corners, rule_.nodes[k]);
      for (std::size_t axis = 0; axis < 3; ++axis)
        coordinates_[(3 * k + axis) * stride_ + panel] = point[static_cast<Index>(axis)];
    }
}

void PointCharges::fill(const Panel& panel, std::size_t first, std::size_t count, double* means) const {
  /// Number of columns whose distances fit in a cache of 32 kB.
  constexpr std::size_t together = 256;
  constexpr std::size_t most_points = 6;
  std::array<double, most_points * 3> rows{};
  for (std::size_t k = 0; k < points(); ++k) {
    const Vector3d point = point_of(panel.corners, rule_.nodes[k]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      rows[3 * k + axis] = point[static_cast<Index>(axis)];
  }
  std::array<double, most_points * together> values{};
  for (std::size_t begin = 0; begin < count; begin += together) {
    const std::size_t here = std::min(together, count - begin), stride = padded(here);
    double* const sums = means + begin;
    std::fill_n(sums, here, 0.0);
    for (std::size_t k = 0; k < points(); ++k) {
      const double* const at = coordinates_.data() + 3 * k * stride_ + first + begin;
      const double* const columns[3] = {at, at + stride_, at + 2 * stride_};
      best_kernels<BatchKernels>().soft_inverse_distances(columns, stride, rows.data(), points(), 0,
                                                          values.data());
      for (std::size_t row = 0; row < points(); ++row) {
        const double weight = rule_.nodes[k].weight * rule_.nodes[row].weight;
        const double* const inverse = values.data() + row * stride;
        for (std::size_t c = 0; c < here; ++c)
          sums[c] += weight * inverse[c];
      }
    }
  }
}

PanelElements::PanelElements(std::span<const Panel> panels, double tolerance)
    : panels_(panels), tolerance_(tolerance), farthest_(1 / far_ratio(tolerance, far_degree)),
      far_(panels, far_degree) {}

bool PanelElements::is_far(const Panel& a, const Panel& b) const {
  const double reach = farthest_ * (a.radius + b.radius);
  return (a.centre - b.centre).squaredNorm() > reach * reach;
}

void PanelElements::fill(const Panel& panel, std::size_t first, std::size_t count, PotentialSums& sums,
                         const Known& known, double* row) const {
  far_.fill(panel, first, count, row);
  for (std::size_t k = 0; k < count; ++k) {
    const Panel& other = panels_[first + k];
    if (is_far(panel, other))
      continue;
    if (known)
      if (const std::optional<double> value = known(first + k)) {
        row[k] = *value;
        continue;
      }
    row[k] = 0;
    add_pair(panel, other, tolerance_, sums, row[k]);
  }
}

MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance, const KnownElements& known,
                             std::size_t threads) {
  const auto size = static_cast<Index>(panels.size());
  MatrixXd matrix(size, size);
  const PanelElements elements(panels, tolerance);
  const auto place = [&](std::size_t panel) { return known.places.empty() ? -1 : known.places[panel]; };
  /// Number of columns whose potentials are evaluated together.
  constexpr std::size_t together = 16;
  parallel_for((panels.size() + together - 1) / together, threads, [&](std::size_t block) {
    PotentialSums sums;
    for (std::size_t i = block * together; i < std::min((block + 1) * together, panels.size()); ++i) {
      double* const column = matrix.data() + static_cast<Index>(i) * size;
      const Index old_i = place(i);
      PanelElements::Known known_of_column;
      if (old_i >= 0)
        known_of_column = [&, old_i](std::size_t j) -> std::optional<double> {
          const Index old_j = place(j);
          return old_j < 0 ? std::nullopt
                           : std::optional(known.matrix(std::min(old_i, old_j), std::max(old_i, old_j)));
        };
      elements.fill(panels[i], 0, i, sums, known_of_column, column);
      column[i] = panel_self(panels[i]);
    }
    sums.flush();
  });
  return matrix;
}

MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance) {
  return single_layer_matrix(panels, tolerance, {MatrixXd(), {}}, 1);
}

MatrixXd panel_potentials(std::span<const Panel> targets, std::span<const Panel> panels,
                          const MatrixXd& charges, double tolerance, std::size_t threads) {
  MatrixXd result(static_cast<Index>(targets.size()), charges.cols());
  const PanelElements elements(panels, tolerance);
  parallel_for(targets.size(), threads, [&](std::size_t k) {
    PotentialSums sums;
    Eigen::VectorXd row(charges.rows());
    elements.fill(targets[k], 0, panels.size(), sums, {}, row.data());
    sums.flush();
    result.row(static_cast<Index>(k)) = row.transpose() * charges;
  });
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
