#include "bem/proximity_refinement.hpp"

#include <algorithm>
#include <cmath>

#include "bem/jacobi_basis.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/gjk.hpp"
#include "numeric/interruption.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<Vector3d> corners_of(const BodySurface& surface) {
  std::vector<Vector3d> corners;
  for (const ChargedFace& face : faces_of(surface))
    for (const Vector3d& corner : corners_of(face))
      corners.push_back(corner);
  for (const Triangle& triangle : triangles_of(surface))
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

/// Returns the half edges of a box around triangles, given by their corners.
Matrix3d half_edges_of_hull(const std::vector<Vector3d>& corners) {
  std::vector<Face> triangles;
  for (std::size_t first = 0; first < corners.size(); first += 3)
    triangles.push_back({first, first + 1, first + 2});
  const OrientedBox box = oriented_box(corners, triangles, BoxMethod::triangles);
  return box.axes.transpose() * box.half_widths.asDiagonal();
}

/// Returns half the longest chord along a direction through a box's projection onto a plane. `along` and
/// `across` are orthogonal directions in the plane.
double half_chord(const Matrix3d& half_edges, const Vector3d& along, const Vector3d& across) {
  Eigen::Matrix<double, 2, 3> projected;
  projected << along.transpose() * half_edges, across.transpose() * half_edges;
  double chord = projected.row(0).cwiseAbs().sum();
  for (Index side = 0; side < 3; ++side) {
    const Eigen::Vector2d edge = projected.col(side);
    if (edge.y() == 0)
      continue;
    // The half chord that ends at the outline's pair of sides parallel to this edge.
    const double area = (edge.x() * projected.row(1) - edge.y() * projected.row(0)).cwiseAbs().sum();
    chord = std::min(chord, area / std::abs(edge.y()));
  }
  return chord;
}

}  // namespace

InducedCharge::InducedCharge(const ChargedBody& body) : corners_(corners_of(body.surface)) {
  const Eigen::Map<const Eigen::Matrix3Xd> points(corners_.front().data(), 3,
                                                  static_cast<Index>(corners_.size()));
  centre_ = points.rowwise().mean();
  radius_ = (points.colwise() - centre_).colwise().norm().maxCoeff();
  if (std::holds_alternative<TriangleSurface>(body.surface)) {
    half_edges_ = half_edges_of_hull(corners_);
  } else {
    const ChargedFace& face = faces_of(body.surface).front();
    half_edges_ << face.half_u * face.axis_u, face.half_v * face.axis_v, face.centre - centre_;
  }
  Vector3d lengths = half_edges_.colwise().norm();
  std::sort(lengths.begin(), lengths.end());
  half_width_ = lengths[1];
}

bool InducedCharge::is_narrow_on(const ChargedFace& face) const {
  const Vector3d normal = face.axis_u.cross(face.axis_v);
  // A body that stands upright has an effect up to about its height away.
  const double height = (normal.transpose() * half_edges_).cwiseAbs().sum();
  const double width_u = std::max(half_chord(half_edges_, face.axis_u, face.axis_v), height);
  const double width_v = std::max(half_chord(half_edges_, face.axis_v, face.axis_u), height);
  const auto is_narrow = [&](double distance) {
    return (width_u + distance) * most_functions / 2 < face.half_u ||
           (width_v + distance) * most_functions / 2 < face.half_v;
  };
  return is_narrow(0) && is_narrow(gjk_distance(corners_, corners_of(face)).distance);
}

bool InducedCharge::is_narrow_on(const Triangle& triangle) const {
  /// Fraction of the triangle's radius below which an induced charge is narrow. The quarters of triangles
  /// sixteen times as large as an induced charge with edges a tenth of that still missed a part of it.
  constexpr double narrow = 1.0 / 2;
  const Panel whole = make_panel(triangle);
  const double least = std::max((whole.centre - centre_).norm() - whole.radius - radius_, 0.0);
  const auto is_narrow = [&](double distance) { return half_width_ + distance < narrow * whole.radius; };
  return is_narrow(least) && is_narrow(gjk_distance(corners_, triangle).distance);
}

std::vector<InducedCharge> induced_charges(const ChargedBodies& bodies) {
  std::vector<InducedCharge> charges;
  for (const ChargedBody& body : bodies.bodies)
    charges.emplace_back(body);
  return charges;
}

void refine_by_proximity(PanelMesh& mesh, const ChargedBodies& bodies, std::size_t most_panels) {
  if (mesh.panels().empty())
    return;
  const std::vector<InducedCharge> charges = induced_charges(bodies);
  const auto is_too_large = [&](const PanelGroup& group) {
    const std::vector<Triangle> triangles = mesh.triangles(group);
    for (std::size_t body = 0; body < charges.size(); ++body)
      if (body != group.body)
        for (const Triangle& triangle : triangles)
          if (charges[body].is_narrow_on(triangle))
            return true;
    return false;
  };
  while (mesh.panels().size() < most_panels) {
    std::vector<int> marked;
    for (const PanelGroup& group : mesh.groups()) {
      check_interruption();
      marked.push_back(is_too_large(group) ? 1 : 0);
    }
    if (std::find(marked.begin(), marked.end(), 1) == marked.end())
      break;
    // Without charges, triangles are halved across their longest sides.
    mesh.refine(marked, Eigen::MatrixXd(index_of(mesh.panels().size()), 0));
  }
}

}  // namespace fringe::detail
