#include "bem/graded_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "bem/edge_density.hpp"
#include "bem/panel.hpp"
#include "bem/single_layer_panels.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector4d;

/// A part of one of the surface's triangles, with the estimated charges of its quarters.
struct GradedPiece {
  Triangle corners;
  std::size_t triangle;
  Vector4d charges;
  double energy;  ///< that the quarters' own densities add to that of one density
};

/// Estimates what one density on a part of a triangle would miss, by the charge density near sharp edges.
class Grading {
 public:
  explicit Grading(std::span<const Triangle> triangles) : density_(triangles) {}

  GradedPiece piece(const Triangle& corners, std::size_t triangle) const {
    /// Relative quadrature tolerance; this matrix only steers refinement.
    constexpr double tolerance = 0.01;
    GradedPiece result{corners, triangle, Vector4d::Zero(), 0};
    std::array<Panel, 4> panels;
    for (std::size_t k = 0; const Triangle& quarter : quarters(corners)) {
      panels[k] = make_panel(quarter);
      result.charges[static_cast<Eigen::Index>(k)] = panels[k].area * mean_density(panels[k], triangle);
      ++k;
    }
    const Vector4d details = result.charges.array() - result.charges.mean();
    const Eigen::Matrix4d own = panel_matrix(panels, tolerance).selfadjointView<Eigen::Upper>();
    result.energy = std::max(details.dot(own * details), 0.0);
    return result;
  }

 private:
  /// Averages the density over three points, which are near enough to the sides to see an edge there.
  double mean_density(const Panel& panel, std::size_t triangle) const {
    double sum = 0;
    for (const Eigen::Vector3d& corner : panel.corners)
      sum += density_.at(triangle, (panel.centre + corner) / 2);
    return sum / 3;
  }

  EdgeDensity density_;
};

}  // namespace

std::vector<Triangle> graded_triangles(std::span<const Triangle> triangles, double missing,
                                       std::size_t most) {
  const Grading grading(triangles);
  std::vector<GradedPiece> pieces;
  double energy = 0, charge = 0, largest = 0;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const GradedPiece& piece = pieces.emplace_back(grading.piece(triangles[k], k));
    energy += piece.energy;
    charge += piece.charges.sum();
  }
  // Estimates the body's energy by that of a ball with the surface's area: its squared charge over its
  // radius.
  const double radius = std::sqrt(area(triangles) / (4 * std::numbers::pi));
  while (energy * radius > missing * charge * charge && pieces.size() < most) {
    /// Fraction of the largest energy. Pieces that hold more are halved in the same step, so that there are
    /// only as many steps as there are sizes.
    constexpr double about = 0.5;
    largest = 0;
    for (const GradedPiece& piece : pieces)
      largest = std::max(largest, piece.energy);
    std::vector<GradedPiece> finer;
    energy = charge = 0;
    for (const GradedPiece& piece : pieces) {
      if (piece.energy < about * largest)
        finer.push_back(piece);
      else
        for (const Triangle& half : halves(piece.corners, side_to_halve(piece.corners, piece.charges)))
          finer.push_back(grading.piece(half, piece.triangle));
    }
    for (const GradedPiece& piece : finer) {
      energy += piece.energy;
      charge += piece.charges.sum();
    }
    pieces = std::move(finer);
  }
  std::vector<Triangle> result;
  result.reserve(pieces.size());
  for (const GradedPiece& piece : pieces)
    result.push_back(piece.corners);
  return result;
}

}  // namespace fringe::detail
