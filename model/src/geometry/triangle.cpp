#include "fringe/triangle.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <utility>

#include "geometry/surface_mesh.hpp"
#include "numeric/compensated.hpp"

namespace fringe {

using Eigen::Vector3d;

double twice_area(const Triangle& triangle) {
  const Vector3d edge0 = triangle[2] - triangle[1];
  const Vector3d edge1 = triangle[0] - triangle[2];
  const Vector3d edge2 = triangle[1] - triangle[0];
  const double squared0 = edge0.squaredNorm(), squared1 = edge1.squaredNorm(), squared2 = edge2.squaredNorm();
  // The two shorter edges carry the smallest rounding error into the cross product.
  if (squared0 >= squared1 && squared0 >= squared2)
    return detail::cross(edge1, edge2).norm();
  if (squared1 >= squared2)
    return detail::cross(edge2, edge0).norm();
  return detail::cross(edge0, edge1).norm();
}

double area(std::span<const Triangle> triangles) {
  return std::accumulate(triangles.begin(), triangles.end(), 0.0,
                         [](double sum, const Triangle& triangle) { return sum + twice_area(triangle) / 2; });
}

double signed_volume(std::span<const Triangle> triangles) {
  if (triangles.empty())
    return 0;
  // The tetrahedra have a point of the surface as their common apex, which avoids cancellation far from the
  // world's origin.
  const Vector3d apex = triangles.front()[0];
  double sixfold = 0;
  for (const Triangle& triangle : triangles)
    sixfold += (triangle[0] - apex).dot((triangle[1] - apex).cross(triangle[2] - apex));
  return sixfold / 6;
}

bool is_closed(std::span<const Triangle> triangles) {
  return detail::SurfaceMesh(triangles).is_closed();
}

Eigen::AlignedBox3d axis_aligned_box(std::span<const Triangle> triangles) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : triangles)
    for (const Vector3d& vertex : triangle)
      box.extend(vertex);
  return box;
}

namespace {

/// Mixes the bits of a number (the finalizer of SplitMix64; Steele, Lea and Flood, OOPSLA 2014, 453).
std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
  return bits ^ (bits >> 31);
}

/// Returns a number that is the same for triangles with the same vertices in any order.
std::uint64_t hash(const Triangle& triangle) {
  std::uint64_t sum = 0;
  for (const Vector3d& vertex : triangle) {
    std::uint64_t bits = 0;
    // Adding 0 makes −0 to +0, which equals it.
    for (const double coordinate : vertex)
      bits = mixed(bits ^ std::bit_cast<std::uint64_t>(coordinate + 0.0));
    sum += bits;
  }
  return sum;
}

bool are_duplicates(const Triangle& a, const Triangle& b, Sides sides) {
  for (std::size_t shift = 0; shift < 3; ++shift) {
    const Vector3d &second = b[(shift + 1) % 3], &third = b[(shift + 2) % 3];
    if (a[0] == b[shift] &&
        ((a[1] == second && a[2] == third) || (sides == Sides::alike && a[1] == third && a[2] == second)))
      return true;
  }
  return false;
}

}  // namespace

std::vector<Triangle> without_duplicates(std::vector<Triangle> triangles, Sides sides) {
  std::vector<std::pair<std::uint64_t, std::size_t>> hashes(triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k)
    hashes[k] = {hash(triangles[k]), k};
  std::sort(hashes.begin(), hashes.end());
  std::vector<bool> repeated(triangles.size(), false);
  for (std::size_t k = 1; k < hashes.size(); ++k)
    for (std::size_t earlier = k; earlier-- > 0 && hashes[earlier].first == hashes[k].first;)
      if (are_duplicates(triangles[hashes[earlier].second], triangles[hashes[k].second], sides)) {
        repeated[hashes[k].second] = true;
        break;
      }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < triangles.size(); ++k)
    if (!repeated[k])
      triangles[kept++] = triangles[k];
  triangles.resize(kept);
  return triangles;
}

}  // namespace fringe
