#include "geometry/surface_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Orders numbers; what is not a number comes last, so that sorting is defined for any.
bool is_less(double a, double b) {
  return a < b || (std::isnan(b) && !std::isnan(a));
}

bool comes_before(const Vector3d& a, const Vector3d& b) {
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (is_less(a[axis], b[axis]) || is_less(b[axis], a[axis]))
      return is_less(a[axis], b[axis]);
  return false;
}

/// A side of a face, from the lower of its vertices to the higher one.
struct FaceSide {
  std::uint32_t from;
  std::uint32_t to;
  std::uint32_t face;
  int direction;  ///< 1 when the face runs along it that way, −1 against it, 0 when its ends are one vertex

  bool operator<(const FaceSide& other) const {
    return std::tie(from, to, face) < std::tie(other.from, other.to, other.face);
  }
};

}  // namespace

SurfaceMesh::SurfaceMesh(std::span<const Triangle> triangles) : faces_(triangles.size()) {
  for (const Triangle& triangle : triangles)
    vertices_.insert(vertices_.end(), triangle.begin(), triangle.end());
  std::sort(vertices_.begin(), vertices_.end(), comes_before);
  const auto same = [](const Vector3d& a, const Vector3d& b) { return !comes_before(a, b); };
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end(), same), vertices_.end());

  std::vector<FaceSide> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto vertex =
          std::lower_bound(vertices_.begin(), vertices_.end(), triangles[k][corner], comes_before);
      faces_[k][corner] = static_cast<std::uint32_t>(vertex - vertices_.begin());
    }
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = faces_[k][corner], to = faces_[k][(corner + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(k),
                       from < to ? 1 : (to < from ? -1 : 0)});
    }
  }
  std::sort(sides.begin(), sides.end());
  faces_of_edges_.reserve(sides.size());
  for (const FaceSide& side : sides)
    faces_of_edges_.push_back(side.face);
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t end = first;
    int balance = 0;
    for (; end < sides.size() && sides[end].from == sides[first].from && sides[end].to == sides[first].to;
         ++end)
      balance += sides[end].direction;
    edges_.push_back({sides[first].from, sides[first].to,
                      std::span(faces_of_edges_).subspan(first, end - first), balance});
    first = end;
  }
}

std::vector<std::vector<std::uint32_t>> SurfaceMesh::neighbours() const {
  std::vector<std::vector<std::uint32_t>> neighbours(faces_.size());
  for (const Edge& edge : edges_)
    for (const std::uint32_t one : edge.faces)
      for (const std::uint32_t other : edge.faces)
        if (one != other)
          neighbours[one].push_back(other);
  return neighbours;
}

std::vector<std::uint32_t> SurfaceMesh::shells() const {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  const auto neighbours = this->neighbours();
  std::vector<std::uint32_t> shells(faces_.size(), none);
  std::vector<std::uint32_t> waiting;
  std::uint32_t count = 0;
  for (std::uint32_t first = 0; first < faces_.size(); ++first) {
    if (shells[first] != none)
      continue;
    shells[first] = count;
    waiting.push_back(first);
    while (!waiting.empty()) {
      const std::uint32_t face = waiting.back();
      waiting.pop_back();
      for (const std::uint32_t neighbour : neighbours[face])
        if (shells[neighbour] == none) {
          shells[neighbour] = count;
          waiting.push_back(neighbour);
        }
    }
    ++count;
  }
  return shells;
}

bool SurfaceMesh::is_closed() const {
  return !faces_.empty() &&
         std::all_of(edges_.begin(), edges_.end(), [](const Edge& edge) { return edge.balance == 0; });
}

bool is_in_polyhedron(std::span<const Triangle> surface, const Vector3d& point) {
  // Half of the triangles' solid angles (A. Van Oosterom and J. Strackee, IEEE Transactions on Biomedical
  // Engineering 30, 1983, 125) add up to 2π times the winding number. Each is the argument of a complex
  // number; that of their product is the sum without whole turns, which are counted.
  std::complex<double> product = 1;
  int turns = 0;
  for (const Triangle& triangle : surface) {
    const Vector3d a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
    const double to_a = a.norm(), to_b = b.norm(), to_c = c.norm();
    const std::complex<double> factor(
        to_a * to_b * to_c + a.dot(b) * to_c + b.dot(c) * to_a + c.dot(a) * to_b, a.dot(b.cross(c)));
    const double squared = std::norm(factor);
    // A triangle has no solid angle from a point on its edge; it counts nothing.
    if (squared == 0)
      continue;
    const bool was_above = product.imag() >= 0, is_above = factor.imag() >= 0;
    product *= factor / std::sqrt(squared);
    if (was_above == is_above && was_above != (product.imag() >= 0))
      turns += was_above ? 1 : -1;
  }
  return std::abs(2 * std::numbers::pi * turns + std::arg(product)) > std::numbers::pi;
}

}  // namespace fringe::detail
