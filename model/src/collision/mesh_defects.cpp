#include "fringe/mesh_defects.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/surface_mesh.hpp"

namespace fringe {
namespace {

using detail::BoxTree;
using detail::SurfaceMesh;
using Eigen::AlignedBox3d;
using Eigen::Vector3d;

bool is_inside(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  /// Largest distance from an edge at which a vertex lies on it, relative to the edge's length: some thousand
  /// times the rounding of coordinates that were computed in double precision.
  constexpr double tolerance = 1e-9;
  const Vector3d edge = to - from;
  const double squared_length = edge.squaredNorm(), along = (point - from).dot(edge) / squared_length;
  return along > tolerance && along < 1 - tolerance &&
         (point - from - along * edge).squaredNorm() <= tolerance * tolerance * squared_length;
}

/// Returns the number of vertices at open edges that lie inside another open edge.
std::size_t t_junctions(const SurfaceMesh& mesh) {
  std::vector<std::uint32_t> ends;
  for (const SurfaceMesh::Edge& edge : mesh.edges())
    if (edge.faces.size() == 1)
      ends.insert(ends.end(), {edge.from, edge.to});
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  if (ends.empty())
    return 0;
  std::vector<AlignedBox3d> boxes;
  boxes.reserve(ends.size());
  for (const std::uint32_t vertex : ends)
    boxes.emplace_back(mesh.vertices()[vertex]);
  const BoxTree tree(boxes);
  std::vector<bool> inside(ends.size(), false);
  for (const SurfaceMesh::Edge& edge : mesh.edges()) {
    if (edge.faces.size() != 1)
      continue;
    const Vector3d &from = mesh.vertices()[edge.from], &to = mesh.vertices()[edge.to];
    AlignedBox3d box(from);
    box.extend(to);
    const Vector3d margin = Vector3d::Constant(1e-9 * (to - from).norm());
    tree.for_each(AlignedBox3d(box.min() - margin, box.max() + margin), [&](std::uint32_t item) {
      inside[item] = inside[item] || is_inside(mesh.vertices()[ends[item]], from, to);
    });
  }
  return static_cast<std::size_t>(std::count(inside.begin(), inside.end(), true));
}

bool have_common_vertex(const SurfaceMesh::Face& a, const SurfaceMesh::Face& b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

/// Returns the number of pairs of triangles without a common vertex that have a point in common.
std::size_t crossings(std::span<const Triangle> triangles, const SurfaceMesh& mesh) {
  std::vector<AlignedBox3d> boxes;
  for (const Triangle& triangle : triangles)
    boxes.push_back(axis_aligned_box({&triangle, 1}));
  const BoxTree tree(boxes);
  std::size_t count = 0;
  for (std::uint32_t a = 0; a < triangles.size(); ++a)
    tree.for_each(boxes[a], [&](std::uint32_t b) {
      if (a < b && !have_common_vertex(mesh.faces()[a], mesh.faces()[b]) &&
          gjk_intersects(triangles[a], triangles[b]).intersects)
        ++count;
    });
  return count;
}

}  // namespace

MeshDefects mesh_defects(std::span<const Triangle> triangles) {
  for (std::size_t k = 0; k < triangles.size(); ++k)
    for (const Vector3d& vertex : triangles[k])
      if (!vertex.allFinite())
        throw InputError(fmt::format("triangle {} has a coordinate that is not finite", k));
  MeshDefects found;
  std::vector<Triangle> sound;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(sound),
               [](const Triangle& triangle) { return twice_area(triangle) > 0; });
  found.without_area = triangles.size() - sound.size();
  const std::size_t with_duplicates = sound.size();
  sound = without_duplicates(std::move(sound));
  found.duplicates = with_duplicates - sound.size();
  if (sound.empty())
    return found;
  const SurfaceMesh mesh(sound);
  for (const SurfaceMesh::Edge& edge : mesh.edges()) {
    found.open_edges += edge.faces.size() == 1 ? 1 : 0;
    found.branching_edges += edge.faces.size() > 2 ? 1 : 0;
    found.flipped_edges += edge.faces.size() == 2 && edge.balance != 0 ? 1 : 0;
  }
  found.t_junctions = t_junctions(mesh);
  found.crossings = crossings(sound, mesh);
  for (const std::uint32_t shell : mesh.shells())
    found.shells = std::max<std::size_t>(found.shells, shell + 1);
  return found;
}

}  // namespace fringe
