#include "bem/film_sheets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "bem/panel_mesh.hpp"
#include "numeric/interruption.hpp"
#include "surface/corner_weld.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::Vector3d;
using ElementEntry = Eigen::Triplet<double>;

/// Distance, relative to a film's size, below which corners are the same.
constexpr double same_film_corner = 1e-8;

/// Returns the corners on the outline of every panel, in their order: its own, and those of other panels on
/// its sides.
std::vector<std::vector<Index>> panel_outlines(const std::vector<Vector3d>& points,
                                               const std::vector<std::array<Index, 3>>& panels,
                                               double tolerance) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    order[k] = k;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return points[a].x() < points[b].x(); });
  std::vector<std::vector<Index>> result;
  for (const auto& panel : panels) {
    check_interruption();
    std::vector<Index>& outline = result.emplace_back();
    for (std::size_t side = 0; side < 3; ++side) {
      const Index from = panel[side], to = panel[(side + 1) % 3];
      const Vector3d& start = points[static_cast<std::size_t>(from)];
      const Vector3d along = points[static_cast<std::size_t>(to)] - start;
      outline.push_back(from);
      std::vector<std::pair<double, Index>> between;
      const double low = start.x() + std::min(0.0, along.x()) - tolerance,
                   high = start.x() + std::max(0.0, along.x()) + tolerance;
      auto at = std::lower_bound(order.begin(), order.end(), low,
                                 [&](std::size_t k, double x) { return points[k].x() < x; });
      for (; at != order.end() && points[*at].x() <= high; ++at) {
        const Vector3d away = points[*at] - start;
        const double part = away.dot(along) / along.squaredNorm();
        if (index_of(*at) != from && index_of(*at) != to && part > 0 && part < 1 &&
            (away - part * along).norm() <= tolerance)
          between.emplace_back(part, index_of(*at));
      }
      std::sort(between.begin(), between.end());
      for (const auto& [part, corner] : between)
        outline.push_back(corner);
    }
  }
  return result;
}

/// Returns the gradients of the three functions that are one at a corner of a triangle, as columns.
Eigen::Matrix3d corner_gradients(const Triangle& triangle) {
  Eigen::Matrix3d result;
  const Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  for (std::size_t k = 0; k < 3; ++k)
    result.col(index_of(k)) =
        normal.cross(triangle[(k + 2) % 3] - triangle[(k + 1) % 3]) / normal.squaredNorm();
  return result;
}

/// Returns the energies of potentials that are one at a corner of a triangle of a film, over 4πε.
Eigen::Matrix3d sheet_stiffness(const Triangle& triangle, double strength) {
  const Eigen::Matrix3d gradients = corner_gradients(triangle);
  return strength * twice_area(triangle) / (8 * std::numbers::pi) * gradients.transpose() * gradients;
}

}  // namespace

FilmSheets::FilmSheets(std::vector<SheetPanel> panels, const BodyAt& body_at, std::size_t bodies)
    : panels_(std::move(panels)) {
  /// Conductance to the ground of all of a film, relative to its strength: it determines the potential of a
  /// film that lies on no conductor, and is far below the capacitances.
  constexpr double leak = 1e-5;
  Eigen::AlignedBox3d box;
  double area = 0;
  for (const SheetPanel& panel : panels_) {
    for (const Vector3d& corner : panel.corners)
      box.extend(corner);
    area += twice_area(panel.corners) / 2;
  }
  const double tolerance = same_film_corner * box.diagonal().norm();
  CornerWeld corners(tolerance);
  for (const SheetPanel& panel : panels_)
    nodes_.push_back({index_of(corners.add(panel.corners[0])), index_of(corners.add(panel.corners[1])),
                      index_of(corners.add(panel.corners[2]))});
  // Panels with corners of others on their sides are divided into fans around their centres.
  std::vector<Vector3d> points = corners.corners();
  const Index count = index_of(panels_.size());
  std::vector<ElementEntry> of_panels, means;
  const std::vector<std::vector<Index>> around = panel_outlines(points, nodes_, tolerance);
  for (std::size_t k = 0; k < panels_.size(); ++k) {
    const std::vector<Index>& outline = around[k];
    std::vector<std::array<Index, 3>> parts{nodes_[k]};
    if (outline.size() > 3) {
      const Triangle& corner = panels_[k].corners;
      points.push_back(centre_of(corner));
      parts.clear();
      for (std::size_t side = 0; side < outline.size(); ++side)
        parts.push_back({index_of(points.size() - 1), outline[side], outline[(side + 1) % outline.size()]});
    }
    for (const std::array<Index, 3>& part : parts) {
      Triangle triangle;
      for (std::size_t corner = 0; corner < 3; ++corner)
        triangle[corner] = points[static_cast<std::size_t>(part[corner])];
      const double part_area = twice_area(triangle) / 2;
      Eigen::Matrix3d element = sheet_stiffness(triangle, panels_[k].strength);
      element.diagonal().array() += leak * panels_[k].strength * part_area / area / (12 * std::numbers::pi);
      for (std::size_t row = 0; row < 3; ++row) {
        means.emplace_back(index_of(k), part[row], part_area / (3 * twice_area(panels_[k].corners) / 2));
        for (std::size_t column = 0; column < 3; ++column)
          of_panels.emplace_back(part[row], part[column], element(index_of(row), index_of(column)));
      }
    }
  }
  const Index nodes = index_of(points.size());
  // Columns of the potentials at nodes: those of free nodes, and of bodies.
  std::vector<ElementEntry> own;
  MatrixXd on_bodies = MatrixXd::Zero(nodes, index_of(bodies));
  Index free = 0;
  for (Index k = 0; k < nodes; ++k) {
    bodies_.push_back(body_at(points[static_cast<std::size_t>(k)]));
    if (bodies_.back())
      on_bodies(k, index_of(*bodies_.back())) = 1;
    else
      own.emplace_back(k, free++, 1);
  }
  nodal_.resize(nodes, free);
  nodal_.setFromTriplets(own.begin(), own.end());
  SparseMatrix<double> elements(nodes, nodes), mean(count, nodes);
  elements.setFromTriplets(of_panels.begin(), of_panels.end());
  mean.setFromTriplets(means.begin(), means.end());
  const SparseMatrix<double> free_elements = nodal_.transpose() * elements * nodal_;
  const SparseMatrix<double> free_means = mean * nodal_;
  const Eigen::SimplicialLDLT<SparseMatrix<double>> factor(free_elements);
  const MatrixXd between = nodal_.transpose() * (elements * on_bodies);
  body_nodal_ = on_bodies - nodal_ * factor.solve(between);
  free_response_ = factor.solve(MatrixXd(free_means.transpose()));
  compliance_ = free_means * free_response_;
  compliance_ = ((compliance_ + compliance_.transpose()) / 2).eval();
  lifts_ = mean * body_nodal_;
  direct_ = body_nodal_.transpose() * (elements * body_nodal_);
}

MatrixXd FilmSheets::corner_potentials(const MatrixXd& charges, const MatrixXd& bodies) const {
  const MatrixXd at_nodes = body_nodal_ * bodies - nodal_ * MatrixXd(free_response_ * charges);
  MatrixXd result(3 * index_of(panels_.size()), charges.cols());
  for (std::size_t k = 0; k < panels_.size(); ++k)
    for (std::size_t corner = 0; corner < 3; ++corner)
      result.row(index_of(3 * k + corner)) = at_nodes.row(nodes_[k][corner]);
  return result;
}

MatrixXd FilmSheets::energy(std::size_t panel, const MatrixXd& corners) const {
  return corners.transpose() * sheet_stiffness(panels_[panel].corners, panels_[panel].strength) * corners;
}

MatrixXd FilmSheets::crowding(std::size_t panel, const MatrixXd& corners) const {
  /// By how much longer than thin films are those beside the border of a conductor below them, in
  /// thicknesses: 2·ln 2/π, as a strip of half width is beside the edge of a plate in its middle (Cohn 1954).
  const double longer = 2 * std::numbers::ln2 / std::numbers::pi;
  for (std::size_t side = 0; side < 3; ++side) {
    const auto from = static_cast<std::size_t>(nodes_[panel][side]),
               to = static_cast<std::size_t>(nodes_[panel][(side + 1) % 3]);
    if (!bodies_[from] || bodies_[from] != bodies_[to])
      continue;
    const Triangle& triangle = panels_[panel].corners;
    const double height = twice_area(triangle) / (triangle[(side + 1) % 3] - triangle[side]).norm();
    return longer * panels_[panel].thickness / height * energy(panel, corners);
  }
  return MatrixXd::Zero(corners.cols(), corners.cols());
}

}  // namespace fringe::detail
