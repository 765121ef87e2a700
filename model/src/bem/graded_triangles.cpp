#include "bem/graded_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "bem/single_layer_panels.hpp"
#include "geometry/surface_mesh.hpp"
#include "numeric/interruption.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

/// Least exponent of a sharp edge. Faces that meet at 160° or more have a smaller one, and so do the facets
/// of a round body.
constexpr double least_exponent = 0.1;

Vector3d opposite_corner(const Triangle& triangle, const Vector3d& from, const Vector3d& to) {
  for (const Vector3d& corner : triangle)
    if (corner != from && corner != to)
      return corner;
  return from;
}

/// Returns the widest angle between neighbouring faces around an edge, on the side where the charge is.
double widest_angle(std::span<const Triangle> triangles, std::span<const std::uint32_t> faces,
                    const Vector3d& from, const Vector3d& to) {
  const Vector3d axis = (to - from).normalized();
  const auto away = [&](std::uint32_t face) -> Vector3d {
    const Vector3d offset = opposite_corner(triangles[face], from, to) - from;
    return offset - offset.dot(axis) * axis;
  };
  const Vector3d first = away(faces.front()), second = axis.cross(first);
  std::vector<double> angles;
  for (const std::uint32_t face : faces) {
    const Vector3d direction = away(face);
    const double angle = std::atan2(direction.dot(second), direction.dot(first));
    angles.push_back(angle < 0 ? angle + 2 * std::numbers::pi : angle);
  }
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t k = 0; k + 1 < angles.size(); ++k)
    widest = std::max(widest, angles[k + 1] - angles[k]);
  return widest;
}

/// Returns true if the faces of a closed surface form a concave edge, as in a corner of a room.
bool is_hollow(std::span<const Triangle> triangles, std::span<const std::uint32_t> faces,
               const Vector3d& from, const Vector3d& to) {
  if (faces.size() != 2)
    return false;
  const Triangle& one = triangles[faces[0]];
  const Vector3d normal = (one[1] - one[0]).cross(one[2] - one[0]);
  return normal.dot(opposite_corner(triangles[faces[1]], from, to) - from) > 0;
}

double charge_exponent(double angle) {
  return 1 - std::numbers::pi / angle;
}

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
    const Eigen::Matrix4d own = single_layer_matrix(panels, tolerance).selfadjointView<Eigen::Upper>();
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

EdgeDensity::EdgeDensity(std::span<const Triangle> triangles)
    : size_(std::sqrt(area(triangles))), part_of_(triangles.size()) {
  const SurfaceMesh mesh(triangles);
  const bool closed = mesh.is_closed(), inside_out = signed_volume(triangles) < 0;
  std::iota(part_of_.begin(), part_of_.end(), std::size_t{0});
  const auto part = [&](std::size_t triangle) {
    while (part_of_[triangle] != triangle)
      triangle = part_of_[triangle];
    return triangle;
  };
  std::vector<std::pair<std::size_t, SharpEdge>> sharp;
  for (const SurfaceMesh::Edge& edge : mesh.edges()) {
    const Vector3d &from = mesh.vertices()[edge.from], &to = mesh.vertices()[edge.to];
    const double exponent = charge_exponent(widest_angle(triangles, edge.faces, from, to));
    const bool is_smooth = exponent < least_exponent;
    const bool grows = !is_smooth && !(closed && !inside_out && is_hollow(triangles, edge.faces, from, to));
    for (const std::uint32_t face : edge.faces) {
      if (grows)
        sharp.push_back({face, {from, to, exponent}});
      else if (is_smooth)
        part_of_[part(face)] = part(edge.faces.front());
    }
  }
  for (std::size_t triangle = 0; triangle < part_of_.size(); ++triangle)
    part_of_[triangle] = part(triangle);
  edges_.resize(triangles.size());
  for (const auto& [triangle, edge] : sharp)
    edges_[part_of_[triangle]].push_back(edge);
}

double EdgeDensity::at(std::size_t triangle, const Vector3d& point) const {
  const std::vector<SharpEdge>& edges = edges_[part_of_[triangle]];
  const SharpEdge* nearest = nullptr;
  double away = 1;
  std::vector<double> distances;
  for (const SharpEdge& edge : edges) {
    distances.push_back(std::min(segment_distance(point, edge.from, edge.to) / size_, 1.0));
    if (nearest == nullptr || distances.back() < away) {
      nearest = &edge;
      away = distances.back();
    }
  }
  if (nearest == nullptr)
    return 1;
  // Near a corner the second edge counts, too; an edge that continues in the same direction is the same edge.
  const Vector3d along = (nearest->to - nearest->from).normalized();
  double other = 1;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    // No exponent is larger than 1/2, that of an angle of 2π.
    const SharpEdge& edge = edges[k];
    if (other * std::sqrt(distances[k]) >= 1)
      continue;
    const double squared_sine = along.cross((edge.to - edge.from).normalized()).squaredNorm();
    other = std::max(other, std::pow(distances[k], -edge.exponent * squared_sine));
  }
  return std::pow(away, -nearest->exponent) * other;
}

std::vector<Triangle> graded_triangles(std::span<const Triangle> triangles, double missing,
                                       std::size_t most) {
  const Grading grading(triangles);
  std::vector<GradedPiece> pieces;
  double energy = 0, charge = 0, largest = 0;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    check_interruption();
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
      check_interruption();
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
